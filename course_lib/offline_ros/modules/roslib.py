"""`roslib`: the calls that old nodes begin with."""

from __future__ import annotations

from types import ModuleType

from course_lib.offline_ros.modules import rospkg

packages = ModuleType("roslib.packages")
packages.__dict__["get_pkg_dir"] = rospkg.get_path
packages.__dict__["InvalidROSPkgException"] = rospkg.ResourceNotFound


def load_manifest(package_name: str) -> None:
    """Do nothing: Python already finds what a node imports."""
    _ = package_name
