"""Writes down what a node does, as a ROS 1 bag."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from rosbags.rosbag1 import Writer

from course_lib.offline_ros.messages import STORE, Message, type_name
from course_lib.offline_ros.wire import serialize

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

ROSOUT = "/rosout"
WINDOWS = "/offline_ros/windows"
OUTCOME = "/offline_ros/outcome"
HIDDEN = {ROSOUT, WINDOWS, OUTCOME}


class Recorder:
    """Writes a recording; safe to use from several threads.

    Parameters
    ----------
    path : Path
        The bag to write; replaced if it exists.
    keep : collection of str, optional
        The node's topics to keep. Default: all.
    """

    def __init__(self, path: Path, keep: Collection[str] | None = None) -> None:
        self._keep = None if keep is None else {*keep, *HIDDEN}
        self.path = path
        path.unlink(missing_ok=True)
        self._writer: Writer | None = Writer(path)
        self._writer.open()
        self._connections: dict[str, Any] = {}
        self._lock = threading.Lock()

    def announce(self, topic: str, msgtype: str, *, latch: bool = False) -> None:
        """Make a topic known, even if nothing is ever published on it."""
        if self._keep is not None and topic not in self._keep:
            return
        with self._lock:
            if self._writer and topic not in self._connections:
                full = msgtype.replace("/", "/msg/")
                self._connections[topic] = self._writer.add_connection(
                    topic, full, typestore=STORE, latching=int(latch)
                )

    def write(self, topic: str, stamp_ns: int, msgtype: str, raw: bytes) -> None:
        """Add a serialized message."""
        self.announce(topic, msgtype)
        with self._lock:
            if self._writer and topic in self._connections:
                self._writer.write(self._connections[topic], stamp_ns, raw)

    def write_message(self, topic: str, stamp_ns: int, message: Message) -> None:
        """Add a message."""
        self.write(topic, stamp_ns, type_name(message), serialize(message))

    def close(self) -> None:
        """Finish the bag; what comes later is dropped."""
        with self._lock:
            if self._writer:
                self._writer.close()
            self._writer = None
