"""What feeds a node, whatever it is: messages at their moments, and perhaps an ear for answers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from course_lib.offline_ros.bag import Arrival


class Source(ABC):
    """The messages that a node gets.

    Attributes
    ----------
    path : Path
        Where they come from, for messages.
    topics : dict of str to str
        What is played, and its message type.
    camera : str or None
        The busiest picture topic.
    frame_count : int
        How many of its pictures will be played.
    rate : float
        Its pictures per second; 0 with fewer than two.
    start_ns : int
        Stamp of the first message.
    """

    path: Path
    topics: dict[str, str]
    camera: str | None
    frame_count: int
    rate: float
    start_ns: int

    @abstractmethod
    def __iter__(self) -> Iterator[Arrival]:
        """Yield the messages in order of time."""

    def hear(  # noqa: B027 (deaf unless it says otherwise)
        self, topic: str, msgtype: str, stamp_ns: int, raw: bytes
    ) -> None:
        """Take note of what the node publishes; a recording does not care.

        Parameters
        ----------
        topic, msgtype : str
        stamp_ns : int
            Simulated time.
        raw : bytes
            In ROS 1's wire format.
        """

    @abstractmethod
    def close(self) -> None:
        """Let go of it."""
