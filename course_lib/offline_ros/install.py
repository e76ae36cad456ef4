"""Puts the stand-in modules where a node's `import` lines look for them."""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, NoReturn

from course_lib.offline_ros.errors import UnsupportedError
from course_lib.offline_ros.messages import STORE, message_class
from course_lib.offline_ros.modules import roslib, rospy

if TYPE_CHECKING:
    from collections.abc import Sequence

PROVIDED = ("cv_bridge", "genpy", "message_filters", "roslib", "rospkg", "rospy")
_INNER = ("roslib", "rospy")  # packages with modules in them
_UNSUPPORTED = {
    "actionlib": "actions need a running ROS",
    "dynamic_reconfigure": "use rospy.get_param",
    "image_geometry": "use cv2 with the matrix K of sensor_msgs/CameraInfo",
    "image_transport": "subscribe to the topic with rospy.Subscriber",
    "rosbag": "the bag is played to the node; pass it with --bag",
    "roslaunch": "run the node file itself, with its parameters as _name:=value",
    "rosnode": "there is no ROS master here",
    "rostopic": "use rospy.Subscriber and rospy.Publisher",
    "std_srvs": "a recording answers no service",
    "tf": "a recording has no transform server",
    "tf2_ros": "a recording has no transform server",
    "tf2_geometry_msgs": "a recording has no transform server",
}


class _MessageModule(ModuleType):
    """`sensor_msgs.msg` and the like: classes are made when they are asked for."""

    def __getattr__(self, name: str) -> object:
        package = self.__name__.partition(".")[0]
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return message_class(f"{package}/{name}")
        except KeyError:
            msg = f"{package} has no message {name}"
            raise AttributeError(msg) from None


class _Refuse(Loader):
    def create_module(self, spec: ModuleSpec) -> NoReturn:
        """Refuse: this part of ROS needs a running ROS."""
        package, _, rest = spec.name.partition(".")
        advice = _UNSUPPORTED.get(package, "of this package there are only the messages, in .msg")
        if package in _INNER:
            advice = rospy.advice(rest) if package == "rospy" else "use rospkg"
        # An ImportError, so that a node with `except ImportError` can do without.
        raise ImportError(str(UnsupportedError(f"import {spec.name}", advice)))

    def exec_module(self, module: ModuleType) -> None:
        """Never reached."""


class _Finder(MetaPathFinder):
    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Refuse what is known to be missing, with a reason."""
        _ = path, target
        package, _, rest = fullname.partition(".")
        if package in _UNSUPPORTED or (rest and package in {*packages(), *_INNER}):
            return ModuleSpec(fullname, _Refuse())
        return None


def packages() -> list[str]:
    """Give the names of the message packages a node can import."""
    return sorted({name.partition("/")[0] for name in STORE.fielddefs} - {"builtin_interfaces"})


def install() -> None:
    """Put all stand-ins into `sys.modules`. For the process that runs a node, and no other."""
    for name in PROVIDED:
        sys.modules[name] = import_module(f"course_lib.offline_ros.modules.{name}")
    inner = {"rospy": rospy.SUBMODULES, "roslib": {"packages": roslib.packages}}
    for package, modules in inner.items():
        # Makes it a package: what else it has on ROS is refused by name.
        sys.modules[package].__path__ = []
        sys.modules |= {f"{package}.{name}": module for name, module in modules.items()}
    for package in packages():
        parent, messages = ModuleType(package), _MessageModule(f"{package}.msg")
        parent.__path__ = []  # makes it a package: `import sensor_msgs.msg` looks inside
        names = [n.rpartition("/")[2] for n in STORE.fielddefs if n.startswith(f"{package}/")]
        messages.__all__ = names  # type: ignore[attr-defined]  # for `from x.msg import *`
        parent.msg = messages  # type: ignore[attr-defined]
        sys.modules[package] = parent
        sys.modules[f"{package}.msg"] = messages
    sys.meta_path.insert(0, _Finder())
