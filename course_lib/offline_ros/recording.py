"""What a node did: published messages, log lines and windows, kept in one ROS 1 bag.

A bag is data, not code: reading one that a stranger's node has written runs nothing.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from rosbags.rosbag1 import Reader, ReaderError

from course_lib.offline_ros.errors import BagError
from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.recorder import HIDDEN, OUTCOME, ROSOUT, WINDOWS
from course_lib.offline_ros.wire import deserialize

if TYPE_CHECKING:
    from tempfile import TemporaryDirectory

    from numpy.typing import NDArray


@dataclass(frozen=True)
class LogLine:
    """One line a node logged.

    Attributes
    ----------
    stamp_ns : int
        Simulated time.
    level : str
        DEBUG, INFO, WARN, ERROR or FATAL.
    text : str
        What it said.
    """

    stamp_ns: int
    level: str
    text: str


class Recording(Mapping[str, list[tuple[int, Any]]]):
    """What a node published, by topic: a list of (stamp in ns, message), in order.

    Parameters
    ----------
    bag : str or Path
        A bag written by `python -m course_lib.offline_ros --record`.
    output : str, optional
        What the node printed.

    Attributes
    ----------
    bag : Path
        The bag itself; `save` keeps a copy of it.
    output : str
        What the node printed, log lines included.
    log : list of LogLine
        What it logged.
    windows : dict of str to ndarray
        The last picture of each `cv2.imshow` window (BGR uint8).
    outcome : dict
        `reason` the node ended, `frames` played, `dropped` messages, `seconds` of wall clock.

    Raises
    ------
    BagError
        When the file is not such a bag.

    Examples
    --------
    >>> recording = run_node("finder.py")  # doctest: +SKIP
    >>> for stamp_ns, message in recording["/object/corners"]:  # doctest: +SKIP
    ...     print(stamp_ns, len(message.polygon.points))
    """

    def __init__(
        self, bag: str | Path, *, output: str = "", folder: TemporaryDirectory[str] | None = None
    ) -> None:
        self.bag = Path(bag)
        self.output = output
        self._folder = folder  # the temporary folder lives as long as the recording
        self._messages: dict[str, list[tuple[int, Any]]] = {}
        try:
            with Reader(self.bag) as reader:
                self._counts = {c.topic: c.msgcount for c in reader.connections}
        except (ReaderError, OSError) as error:
            msg = f"{self.bag} is not a recording: {error}"
            raise BagError(msg) from error

    def __getitem__(self, topic: str) -> list[tuple[int, Any]]:
        if topic not in self._counts:
            known = ", ".join(self) or "nothing"
            msg = f"the node did not publish {topic}; it published {known}"
            raise KeyError(msg)
        if topic not in self._messages:
            self._messages[topic] = list(self.stream(topic))
        return self._messages[topic]

    def stream(self, topic: str) -> Iterator[tuple[int, Any]]:
        """Read a topic message by message, for pictures that would not fit into memory at once.

        Parameters
        ----------
        topic : str
            A topic the node published; of any other there is nothing.

        Yields
        ------
        stamp_ns : int
            When it was published.
        message : Message
            What was published.
        """
        with Reader(self.bag) as reader:
            connections = [c for c in reader.connections if c.topic == topic]
            for connection, stamp_ns, raw in reader.messages(connections) if connections else ():
                yield stamp_ns, deserialize(raw, connection.msgtype)

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._counts.keys() - HIDDEN))

    def __len__(self) -> int:
        return len(self._counts.keys() - HIDDEN)

    def __repr__(self) -> str:
        rows = [f"  {topic}: {self._counts[topic]} messages" for topic in self]
        rows += [
            f"  {name} (log lines): {self._counts[name]}" for name in {ROSOUT} & {*self._counts}
        ]
        rows += [f"  window {name!r}" for name in self.windows]
        return "\n".join([f"Recording, {self.outcome.get('frames', 0)} pictures played", *rows])

    def _hidden(self, topic: str) -> list[tuple[int, Any]]:
        return self[topic] if topic in self._counts else []

    @cached_property
    def log(self) -> list[LogLine]:
        """What the node logged."""
        cls = message_class("rosgraph_msgs/Log")
        levels = {getattr(cls, name): name for name in ("DEBUG", "INFO", "WARN", "ERROR", "FATAL")}
        return [LogLine(t, levels[line.level], line.msg) for t, line in self._hidden(ROSOUT)]

    @cached_property
    def windows(self) -> dict[str, NDArray[np.uint8]]:
        """The last picture of each window the node opened."""
        return {
            shown.header.frame_id: np.asarray(
                cv2.imdecode(np.frombuffer(shown.data, np.uint8), cv2.IMREAD_COLOR), np.uint8
            )
            for _, shown in self._hidden(WINDOWS)
        }

    @cached_property
    def outcome(self) -> dict[str, Any]:
        """How the run ended."""
        found = self._hidden(OUTCOME)
        return dict(json.loads(found[-1][1].data)) if found else {}

    def save(self, path: str | Path) -> Path:
        """Keep a copy of the bag, which any ROS tool can read.

        Parameters
        ----------
        path : str or Path
            Where; replaced if it exists.

        Returns
        -------
        Path
            Where it now is.
        """
        return Path(shutil.copyfile(self.bag, path))
