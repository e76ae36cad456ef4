"""`rospy`, for one node without a ROS master."""

from __future__ import annotations

from types import ModuleType
from typing import NoReturn

from course_lib.offline_ros import exceptions
from course_lib.offline_ros.errors import UnsupportedError
from course_lib.offline_ros.exceptions import (
    ROSException,
    ROSInitException,
    ROSInternalException,
    ROSInterruptException,
    ROSSerializationException,
    ROSTimeMovedBackwardsException,
    ServiceException,
    TransportException,
    TransportInitError,
    TransportTerminated,
)
from course_lib.offline_ros.messages import Message, message_class
from course_lib.offline_ros.modules import _rospy_log, _rospy_numpy
from course_lib.offline_ros.modules._rospy_node import (
    DEBUG,
    ERROR,
    FATAL,
    INFO,
    WARN,
    get_caller_id,
    get_name,
    get_namespace,
    get_node_uri,
    get_published_topics,
    init_node,
    is_shutdown,
    myargv,
    on_shutdown,
    remap_name,
    resolve_name,
    signal_shutdown,
    spin,
)
from course_lib.offline_ros.modules._rospy_param import (
    delete_param,
    get_param,
    get_param_cached,
    get_param_names,
    has_param,
    search_param,
    set_param,
)
from course_lib.offline_ros.modules._rospy_time import (
    Rate,
    Timer,
    get_rostime,
    get_time,
    sleep,
)
from course_lib.offline_ros.modules._rospy_topics import Publisher, Subscriber, wait_for_message
from course_lib.offline_ros.times import Duration, Time

Header = message_class("std_msgs/Header")

__all__ = [
    "DEBUG",
    "ERROR",
    "FATAL",
    "INFO",
    "WARN",
    "Duration",
    "Header",
    "Message",
    "Publisher",
    "ROSException",
    "ROSInitException",
    "ROSInternalException",
    "ROSInterruptException",
    "ROSSerializationException",
    "ROSTimeMovedBackwardsException",
    "Rate",
    "ServiceException",
    "Subscriber",
    "Time",
    "Timer",
    "TransportException",
    "TransportInitError",
    "TransportTerminated",
    "delete_param",
    "exceptions",
    "get_caller_id",
    "get_name",
    "get_namespace",
    "get_node_uri",
    "get_param",
    "get_param_cached",
    "get_param_names",
    "get_published_topics",
    "get_rostime",
    "get_time",
    "has_param",
    "init_node",
    "is_shutdown",
    "myargv",
    "on_shutdown",
    "remap_name",
    "resolve_name",
    "rostime",
    "search_param",
    "set_param",
    "signal_shutdown",
    "sleep",
    "spin",
    "wait_for_message",
]


def _module(name: str, **names: object) -> ModuleType:
    made = ModuleType(f"rospy.{name}")
    made.__dict__.update(names)
    return made


# The same names once more, under the modules that some nodes import them from.
rostime = _module(
    "rostime",
    Duration=Duration,
    Time=Time,
    get_rostime=get_rostime,
    get_time=get_time,
    wallsleep=sleep,
    Rate=Rate,
)
timer = _module("timer", Rate=Rate, Timer=Timer, sleep=sleep)
numpy_msg = _module("numpy_msg", numpy_msg=_rospy_numpy.numpy_msg)
SUBMODULES = {"exceptions": exceptions, "rostime": rostime, "timer": timer, "numpy_msg": numpy_msg}

globals().update(_rospy_log.FUNCTIONS)

_SERVICES = "a recording answers no service; use topics, or run the node on ROS"
_INNER = "use what rospy itself offers"
_UNSUPPORTED = {
    "AnyMsg": "subscribe with the topic's own message class",
    "MasterProxy": "there is no ROS master here",
    "Service": _SERVICES,
    "ServiceProxy": _SERVICES,
    "SubscribeListener": "publish without waiting for listeners",
    "get_master": "there is no ROS master here",
    "get_ros_root": "there is no ROS installation here",
    "client": _INNER,
    "core": _INNER,
    "impl": _INNER,
    "logout": "use rospy.loginfo",
    "msg": "import message classes from std_msgs.msg and the like",
    "msproxy": _INNER,
    "names": "use rospy.resolve_name",
    "parse_rosrpc_uri": _SERVICES,
    "service": _SERVICES,
    "topics": "use rospy.Publisher and rospy.Subscriber",
    "wait_for_service": _SERVICES,
}


def advice(name: str) -> str:
    """Say what to use instead of a part of rospy that is not there."""
    return _UNSUPPORTED.get(name, _INNER)


def __getattr__(name: str) -> NoReturn:
    if name in _UNSUPPORTED:
        raise UnsupportedError(f"rospy.{name}", _UNSUPPORTED[name])
    msg = f"module 'rospy' has no attribute {name!r}"
    raise AttributeError(msg)
