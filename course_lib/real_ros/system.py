"""What real ROS needs of this machine: Debian's packages and an environment without ours."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

# The Python that Debian's ROS, cv_bridge and OpenCV belong to.
PYTHON = Path("/usr/bin/python3")
_PROGRAMS = ("roscore", "roslaunch", "rosbag", "rostopic")
_MODULES = ("rospy", "rosbag", "message_filters", "sensor_msgs", "cv_bridge", "cv2")
_PACKAGES = Path("/usr/lib/python3/dist-packages")
# What ROS, Python or OpenCV would take from the caller's environment.
_FOREIGN = ("ROS_", "ROSLISP_", "PYTHON", "VIRTUAL_ENV", "MPLBACKEND", "CMAKE_PREFIX_PATH")


def complaint() -> str | None:
    """Say what is missing here for real ROS; None if nothing is."""
    missing = [name for name in _PROGRAMS if not Path("/usr/bin", name).exists()]
    missing += [name for name in _MODULES if not any(_PACKAGES.glob(f"{name}*"))]
    if not missing:
        return None
    return (
        f"ROS 1 is not installed, or not all of it (no {', '.join(missing)}): `make system` "
        "installs it on Debian 12"
    )


def environment(folder: Path, port: int, package_path: Iterable[str | Path]) -> dict[str, str]:
    """Give the environment of a program that uses a master of ours.

    Parameters
    ----------
    folder : Path
        Where ROS keeps its own files; nodes run there.
    port : int
        The master's.
    package_path : iterable of str or Path
        Folders that hold ROS packages.

    Returns
    -------
    dict of str to str
        The caller's, without what belongs to another Python or another master. Debian's programs
        come first on `PATH`: a node begins with `#!/usr/bin/env python3`, and the `python3` of a
        virtual environment or of pyenv has no rospy.
    """
    kept = {name: value for name, value in os.environ.items() if not name.startswith(_FOREIGN)}
    return kept | {
        "PATH": os.pathsep.join(["/usr/bin", "/bin", os.environ.get("PATH", "")]),
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "ROS_IP": "127.0.0.1",
        "ROS_HOME": str(folder),
        "ROS_LOG_DIR": str(folder / "log"),
        "ROS_PACKAGE_PATH": os.pathsep.join(str(Path(path).resolve()) for path in package_path),
        "PYTHONUNBUFFERED": "1",
    }
