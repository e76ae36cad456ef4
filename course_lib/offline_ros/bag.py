"""What feeds a node: the messages of a bag, in the order in which they were recorded."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from course_lib import images
from course_lib.offline_ros.errors import BagError
from course_lib.offline_ros.messages import STORE, message_class
from course_lib.offline_ros.source import Source
from course_lib.offline_ros.wire import from_native

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator

_IMAGE = "sensor_msgs/Image"
_COMPRESSED_IMAGE = "sensor_msgs/CompressedImage"


@dataclass(frozen=True)
class Arrival:
    """A message of the recording, read only when somebody listens.

    Attributes
    ----------
    stamp_ns : int
        When it was recorded.
    topic, msgtype : str
        Where it goes and what it is, such as `sensor_msgs/Image`.
    load : callable
        Gives the message.
    """

    stamp_ns: int
    topic: str
    msgtype: str
    load: Callable[[], Any]


def find_bag(bag: str | Path) -> Path:
    """Find a bag by path, or by name in the course's `images` folder.

    Parameters
    ----------
    bag : str or Path
        A file (for ROS 2 a folder), or a name such as `flight.bag`.

    Returns
    -------
    Path
        Where it is.

    Raises
    ------
    BagError
        When there is none; the message lists the bags of the course.
    """
    path = Path(bag)
    if path.exists():
        return path.resolve()
    try:
        return images.path(path.as_posix())
    except (images.MissingImageError, ValueError) as error:
        msg = f"no bag {str(bag)!r} here, nor among the course's images. {error}"
        raise BagError(msg) from error


class BagSource(Source):
    """The messages of a bag.

    Each `X/compressed` topic of type `sensor_msgs/CompressedImage` also appears as `X`, a
    decompressed `sensor_msgs/Image`, as a camera driver would publish it. Topics whose type is
    not among ROS 1's common messages are left out.

    Parameters
    ----------
    bag : str or Path
        A ROS 1 bag, or a ROS 2 bag (mcap, sqlite3), by path or by the course's name for it.
    topics : collection of str, optional
        Play only these topics. Default: all.
    max_frames : int, optional
        Stop after this many pictures of the busiest picture topic.

    Attributes
    ----------
    topics : dict of str to str
        What is played, and its message type.
    camera : str or None
        The busiest picture topic.
    frame_count : int
        How many of its pictures will be played.
    rate : float
        Its pictures per second when it was recorded; 0 with fewer than two pictures.
    start_ns : int
        Stamp of the first message.

    Raises
    ------
    BagError
        When the bag is missing, unreadable, empty, or has no such topic.
    """

    def __init__(
        self,
        bag: str | Path,
        *,
        topics: Collection[str] | None = None,
        max_frames: int | None = None,
    ) -> None:
        if max_frames is not None and max_frames < 1:
            msg = f"max_frames must be at least 1, not {max_frames}"
            raise ValueError(msg)
        self.path = find_bag(bag)
        try:
            self._reader = AnyReader(
                # Old ROS 2 recordings do not carry their message definitions.
                [self.path],
                default_typestore=get_typestore(Stores.ROS2_HUMBLE),
            )
            self._reader.open()
        except Exception as error:  # rosbags lets struct, sqlite and assertion errors through
            msg = f"{self.path.name} cannot be read as a ROS bag: {error}"
            raise BagError(msg) from error
        offered = [
            (connection, topic, msgtype)
            for connection in self._reader.connections
            for topic, msgtype in _offered(connection.topic, connection.msgtype)
        ]
        if missing := sorted(set(topics or ()) - {topic for _, topic, _ in offered}):
            known = ", ".join(sorted({topic for _, topic, _ in offered}))
            msg = f"{self.path.name} has no topic {', '.join(missing)}; it has {known}"
            raise BagError(msg)
        chosen = [entry for entry in offered if topics is None or entry[1] in topics]
        if not sum(connection.msgcount for connection, _, _ in chosen):
            msg = f"{self.path.name} holds no message that can be played"
            raise BagError(msg)
        self.topics = {topic: msgtype for _, topic, msgtype in chosen}
        self._connections = {connection.id: connection for connection, _, _ in chosen}
        self.start_ns = self._reader.start_time
        pictures = {t: c.msgcount for c, t, kind in chosen if kind in {_IMAGE, _COMPRESSED_IMAGE}}
        # Of a compressed topic and its decompressed twin, the twin has the shorter name.
        self.camera = max(pictures, key=lambda t: (pictures[t], -len(t)), default=None)
        total = pictures[self.camera] if self.camera else 0
        seconds = self._reader.duration / 1e9
        self.rate = (total - 1) / seconds if total > 1 and seconds > 0 else 0.0
        self._max_frames = max_frames
        self.frame_count = total if max_frames is None else min(total, max_frames)

    def __iter__(self) -> Iterator[Arrival]:
        frames = 0
        for connection, stamp_ns, raw in self._raw():
            load = self._loader(connection.msgtype, raw)
            for topic, msgtype in _offered(connection.topic, connection.msgtype):
                if topic not in self.topics:
                    continue
                if topic == self.camera:
                    if frames == self._max_frames:
                        return
                    frames += 1
                if topic == connection.topic:
                    yield Arrival(stamp_ns, topic, msgtype, load)
                else:
                    yield Arrival(stamp_ns, topic, msgtype, _decompressor(load))

    def _raw(self) -> Iterator[tuple[Any, int, bytes]]:
        try:
            yield from self._reader.messages(list(self._connections.values()))
        except Exception as error:  # rosbags lets struct and assertion errors through
            msg = f"{self.path.name} is damaged: {error}"
            raise BagError(msg) from error

    def _loader(self, msgtype: str, raw: bytes) -> Callable[[], Any]:
        @lru_cache(maxsize=1)
        def load() -> Any:  # noqa: ANN401  (any message class)
            try:
                return from_native(self._reader.deserialize(raw, msgtype), msgtype)
            except Exception as error:
                msg = f"{self.path.name} is damaged: {error}"
                raise BagError(msg) from error

        return load

    def close(self) -> None:
        """Close the bag."""
        self._reader.close()


def _offered(topic: str, msgtype: str) -> Iterator[tuple[str, str]]:
    """Give the topics that a recorded topic is played as."""
    short = msgtype.replace("/msg/", "/")
    if short == _COMPRESSED_IMAGE and topic.endswith("/compressed"):
        yield topic.removesuffix("/compressed"), _IMAGE
    if msgtype in STORE.fielddefs:
        yield topic, short


def _decompressor(load: Callable[[], Any]) -> Callable[[], Any]:
    return lru_cache(maxsize=1)(lambda: decompress(load()))


def decompress(compressed: Any) -> Any:  # noqa: ANN401  (messages are made at run time)
    """Turn a compressed picture into the raw one that the camera had sent.

    Parameters
    ----------
    compressed : sensor_msgs/CompressedImage
        JPEG or PNG. Its `format`, such as "rgb8; jpeg compressed bgr8", names the encoding
        that the camera had; "jpeg" alone means bgr8 (mono8 for a grey picture).

    Returns
    -------
    sensor_msgs/Image
        The picture with the same header.

    Raises
    ------
    BagError
        When the data is no picture.
    """
    data = np.frombuffer(compressed.data, np.uint8)
    pixels = cv2.imdecode(data, cv2.IMREAD_UNCHANGED) if data.size else None
    if pixels is None:
        msg = f"the compressed picture at {compressed.header.stamp.to_sec():.3f} s is damaged"
        raise BagError(msg)
    named = re.match(r"\s*(bgr8|rgb8|mono8|bgra8|rgba8)\s*;", compressed.format)
    encoding = {2: "mono8", 3: "bgr8"}.get(pixels.ndim, "bgr8")
    if pixels.ndim == 3 and pixels.shape[2] == 4:
        encoding = "bgra8"
    if named and named[1] == "rgb8" and encoding == "bgr8":
        pixels, encoding = cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB), "rgb8"
    height, width = pixels.shape[:2]
    return message_class(_IMAGE)(
        header=compressed.header,
        height=height,
        width=width,
        encoding=encoding if pixels.dtype == np.uint8 else "mono16",
        is_bigendian=0,
        step=pixels.strides[0],
        data=pixels.tobytes(),
    )
