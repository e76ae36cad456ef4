"""`rospy.loginfo` and its 19 siblings."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from course_lib.offline_ros.modules import get_runtime

if TYPE_CHECKING:
    from collections.abc import Callable

_FAMILIES = {
    "debug": "DEBUG",
    "info": "INFO",
    "warn": "WARN",
    "err": "ERROR",
    "fatal": "FATAL",
}

# What the throttled functions remember: by place in the node's file, the last time and text.
_said: dict[tuple[str, int], tuple[int, str]] = {}


def _caller() -> tuple[str, int]:
    frame = sys._getframe(2)  # noqa: SLF001  (rospy tells calls apart by where they stand)
    return frame.f_code.co_filename, frame.f_lineno


def _format(msg: object, args: tuple[object, ...]) -> str:
    # As Python's logging does: a single dictionary fills %(name)s.
    if len(args) == 1 and isinstance(args[0], dict) and args[0]:
        return str(msg) % args[0]
    return str(msg) % args if args else str(msg)


def _make(family: str, level: str) -> dict[str, Callable[..., None]]:
    def log(msg: object, *args: object, **_kwargs: object) -> None:
        get_runtime().console.log(level, _format(msg, args))

    def once(msg: object, *args: object, **_kwargs: object) -> None:
        place = _caller()
        if place not in _said:
            _said[place] = (0, "")
            get_runtime().console.log(level, _format(msg, args))

    def throttle(period: float, msg: object, *args: object, **_kwargs: object) -> None:
        _throttle(_caller(), period, _format(msg, args), identical=False)

    def throttle_identical(period: float, msg: object, *args: object, **_kwargs: object) -> None:
        _throttle(_caller(), period, _format(msg, args), identical=True)

    def _throttle(place: tuple[str, int], period: float, text: str, *, identical: bool) -> None:
        now = get_runtime().now_ns()
        last = _said.get(place)
        if last and now - last[0] < period * 1e9 and (not identical or last[1] == text):
            return
        _said[place] = (now, text)
        get_runtime().console.log(level, text)

    made: dict[str, Callable[..., None]] = {
        f"log{family}": log,
        f"log{family}_once": once,
        f"log{family}_throttle": throttle,
        f"log{family}_throttle_identical": throttle_identical,
    }
    for name, function in made.items():
        function.__name__ = function.__qualname__ = name
        function.__doc__ = f"Log at level {level}, as `rospy.{name}` does."
    return made


FUNCTIONS: dict[str, Any] = {}
for _family, _level in _FAMILIES.items():
    FUNCTIONS |= _make(_family, _level)
