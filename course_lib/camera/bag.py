"""Frames from ROS recordings, read without ROS: ROS 1 bags, ROS 2 mcap and sqlite3."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from course_lib.camera.decode import decode_compressed, decode_image
from course_lib.camera.frames import CameraError, Frame, FrameSource, TruthByStamp

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

BAG_SUFFIXES = (".bag", ".mcap", ".db3")
DECODERS = {
    "sensor_msgs/msg/Image": decode_image,
    "sensor_msgs/msg/CompressedImage": decode_compressed,
}


def is_bag(place: Path) -> bool:
    """Tell whether a path is a recording: by its suffix, or by a ROS 2 folder's metadata."""
    if place.is_dir():
        return (place / "metadata.yaml").is_file()
    return place.suffix.lower() in BAG_SUFFIXES


class BagSource(FrameSource):
    """
    The pictures of one topic of a recording, in the order in which they were recorded.

    Parameters
    ----------
    place : Path
        A ``.bag`` file, a ROS 2 folder, or a single ``.mcap`` or ``.db3`` file.
    topic : str or None
        None takes the only image topic there is.

    Raises
    ------
    CameraError
        Unreadable, no such topic, or several to choose from.
    """

    def __init__(self, place: Path, *, topic: str | None = None) -> None:
        super().__init__(str(place))
        self._truth = TruthByStamp(place)
        # Old ROS 2 recordings do not carry their message definitions.
        store = get_typestore(Stores.ROS2_HUMBLE)
        try:
            self._reader: Any = AnyReader([place], default_typestore=store)
            self._reader.open()
        except Exception as error:  # rosbags lets struct, sqlite and assertion errors through
            raise CameraError(
                f"{place} is not a readable recording: {error}. "
                "If it was cut off while recording, `rosbag reindex` or `ros2 bag reindex` helps"
            ) from error
        try:
            self._connections = self._choose(topic)
        except CameraError:
            self.close()
            raise
        self.topic: str = self._connections[0].topic

    def _choose(self, topic: str | None) -> list[Any]:
        pictures = [entry for entry in self._reader.connections if entry.msgtype in DECODERS]
        topics = sorted({entry.topic for entry in pictures})
        listing = ", ".join(topics) if topics else "none"
        if topic is not None and topic not in topics:
            raise CameraError(
                f"{self.name} has no image topic {topic!r}; its image topics: {listing}"
            )
        if not topics:
            others = sorted({entry.topic for entry in self._reader.connections})
            raise CameraError(
                f"{self.name} has no image topic; its topics: {', '.join(others) or 'none'}"
            )
        if topic is None and len(topics) > 1:
            raise CameraError(f"{self.name} has several image topics, choose one: {listing}")
        return [entry for entry in pictures if entry.topic == (topic or topics[0])]

    def __len__(self) -> int:
        return self._count

    @property
    def _count(self) -> int:
        # Asked before the reader closes, which forgets its connections.
        return sum(entry.msgcount for entry in self._connections)

    def _read(self) -> Iterator[Frame]:
        try:
            for connection, received_ns, data in self._reader.messages(self._connections):
                message = self._reader.deserialize(data, connection.msgtype)
                taken = message.header.stamp
                # An unset stamp is zero; the time of recording is then the best there is.
                stamp_ns = taken.sec * 1_000_000_000 + taken.nanosec or received_ns
                image = DECODERS[connection.msgtype](message)
                yield Frame(stamp_ns, image, self._truth.at(stamp_ns))
        except CameraError as error:
            raise CameraError(f"{self.name}, {self.topic}: {error}") from error
        except Exception as error:  # rosbags lets struct, sqlite and assertion errors through
            raise CameraError(f"{self.name} is damaged: {error}") from error

    def _release(self) -> None:
        # The reader refuses to be closed twice.
        if self._reader.stack is not None:
            self._reader.close()
