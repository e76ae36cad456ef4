"""The modules a ROS 1 node imports, as `offline_ros` provides them.

Each file here stands in `sys.modules` under its plain name (`rospy`, `cv_bridge`, …), but only
in the process that runs a node: nothing here shadows an installed ROS.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from course_lib.offline_ros.runtime import Runtime

_RUNTIMES: list[Runtime] = []


def set_runtime(runtime: Runtime) -> None:
    """Say which runtime serves the node of this process."""
    _RUNTIMES[:] = [runtime]


def get_runtime() -> Runtime:
    """Give the runtime that serves the node of this process.

    Returns
    -------
    Runtime
        The only one.

    Raises
    ------
    RuntimeError
        When no node runs here.
    """
    if not _RUNTIMES:
        msg = "these modules work only in a node run by `python -m course_lib.offline_ros`"
        raise RuntimeError(msg)
    return _RUNTIMES[0]
