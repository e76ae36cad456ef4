"""Log lines as ROS 1 prints them: `[INFO] [1606000000.123456]: text`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.recorder import ROSOUT, Recorder
from course_lib.offline_ros.times import Time

if TYPE_CHECKING:
    from collections.abc import Callable

LEVELS = {"DEBUG": 1, "INFO": 2, "WARN": 4, "ERROR": 8, "FATAL": 16}
_COLOURS = {"DEBUG": "\033[32m", "WARN": "\033[33m", "ERROR": "\033[31m", "FATAL": "\033[31m"}


class Console:
    """Prints and records what a node logs.

    Parameters
    ----------
    recorder : Recorder, optional
        Keeps the lines on `/rosout`.
    """

    def __init__(self, recorder: Recorder | None = None) -> None:
        self._recorder = recorder
        self.threshold = LEVELS["INFO"]
        self.node = ""
        self.now_ns: Callable[[], int] = lambda: 0

    def log(self, level: str, text: str) -> None:
        """Write one line: information to stdout, warnings and errors to stderr.

        Parameters
        ----------
        level : str
            DEBUG, INFO, WARN, ERROR or FATAL.
        text : str
            What to say.
        """
        if LEVELS[level] < self.threshold:
            return
        stamp_ns = self.now_ns()
        stream = sys.stdout if LEVELS[level] < LEVELS["WARN"] else sys.stderr
        # The stamp is simulated time, so the same run prints the same lines.
        line = f"[{level}] [{stamp_ns // 10**9}.{stamp_ns % 10**9 // 1000:06d}]: {text}"
        if stream.isatty() and level in _COLOURS:
            line = f"{_COLOURS[level]}{line}\033[0m"
        print(line, file=stream, flush=True)
        if self._recorder:
            entry = message_class("rosgraph_msgs/Log")(
                level=LEVELS[level], name=self.node, msg=text
            )
            entry.header.stamp = Time.from_nsec(stamp_ns)
            self._recorder.write_message(ROSOUT, stamp_ns, entry)
