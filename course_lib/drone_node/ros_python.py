"""Which Python has rospy: rarely the one of the course."""

from __future__ import annotations

import os
import shutil
import subprocess

PACKAGES = "python3-rospy python3-roslaunch python3-sensor-msgs python3-geometry-msgs"


class NoRosError(RuntimeError):
    """No Python on this machine has rospy; the message says what to install."""


def find() -> str:
    """Return the path of a Python that can import rospy.

    Returns
    -------
    str
        `ROS_PYTHON` of the environment first, then the system's own, then what is on the path.

    Raises
    ------
    NoRosError
        None has rospy.
    """
    named = os.environ.get("ROS_PYTHON")
    candidates = [named] if named else ["/usr/bin/python3", shutil.which("python3")]
    for python in candidates:
        if python and shutil.which(python) and _has_rospy(python):
            return python
    raise NoRosError(
        f"no Python here can import rospy (tried {', '.join(filter(None, candidates))}). "
        f"On Debian: apt install {PACKAGES}; with a ROS of your own, source its setup.bash first, "
        "or name its Python in ROS_PYTHON"
    )


def environment() -> dict[str, str]:
    """Return this process's environment without what binds it to the course's Python."""
    bound = {"VIRTUAL_ENV", "PYTHONHOME", "__PYVENV_LAUNCHER__"}
    return {name: value for name, value in os.environ.items() if name not in bound}


def _has_rospy(python: str) -> bool:
    tried = subprocess.run(  # noqa: S603 (a Python of this machine)
        [python, "-c", "import rospy"], env=environment(), capture_output=True, check=False
    )
    return tried.returncode == 0
