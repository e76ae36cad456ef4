"""Frames from recorded flights, a simulated drone, videos, webcams and folders, one iterator."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from course_lib import images
from course_lib.camera.bag import BagSource, is_bag
from course_lib.camera.flown import DroneSource, is_drone
from course_lib.camera.folder import FolderSource
from course_lib.camera.frames import CameraError, Frame, FrameSource
from course_lib.camera.video import VIDEO_SUFFIXES, VideoSource

__all__ = ["CameraError", "Frame", "FrameSource", "open_camera"]


def open_camera(
    source: str | Path | int | Any,  # noqa: ANN401 (a Drone, which must not be imported here)
    *,
    topic: str | None = None,
    rate: float = 30.0,
) -> FrameSource:
    """
    Open a source of timestamped frames.

    Parameters
    ----------
    source : str, Path, int or Drone
        A recorded flight, by the name of a course file (``"flight.bag"``) or by path: a ROS 1 bag,
        or a ROS 2 recording (its folder, or a single ``.mcap`` or ``.db3`` file); a video file; a
        folder of pictures; a webcam by number or device (``0``, ``"/dev/video0"``); a stream's
        address (``"rtsp://…"``); or the simulated drone: ``"drone"`` for one that hovers, or a
        :class:`course_lib.drone.Drone` of your own that you steer between its frames.
    topic : str or None
        Which image topic of a recording; None takes the only one there is.
    rate : float
        Frames per second of a folder of pictures, whose files do not say, and of the simulated
        drone. Files named by their time in nanoseconds keep that time.

    Returns
    -------
    FrameSource
        An iterator of :class:`Frame`. It closes itself after the last frame; use it in a ``with``
        statement when you may stop earlier. ``len()`` works where the number of frames is known.

    Raises
    ------
    CameraError
        Nothing to read there, or it is damaged; later too, while iterating.
    TypeError
        The source is neither a path nor a number.

    Examples
    --------
    >>> import cv2, numpy as np, tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     for number in range(3):
    ...         name = f"{place}/frame_{number}.png"
    ...         _ = cv2.imwrite(name, np.full((48, 64, 3), number, np.uint8))
    ...     for frame in open_camera(place, rate=10):
    ...         print(frame.stamp_ns, frame.image.shape, frame.image[0, 0, 0])
    0 (48, 64, 3) 0
    100000000 (48, 64, 3) 1
    200000000 (48, 64, 3) 2
    """
    if is_drone(source):
        return DroneSource(source, rate=rate)
    if isinstance(source, bool) or not isinstance(source, str | Path | int):
        raise TypeError(f"source must be a path, a webcam's number or a drone, got {source!r}")
    if isinstance(source, int):
        return VideoSource(source)
    text = str(source)
    if re.fullmatch(r"\d+", text):
        return VideoSource(int(text))
    if "://" in text or text.startswith("/dev/"):
        return VideoSource(text)
    place = _resolve(Path(source))
    if is_bag(place):
        return BagSource(place, topic=topic)
    if topic is not None:
        raise CameraError(f"{place} is not a recording with topics: leave topic out")
    if place.is_dir():
        return FolderSource(place, rate=rate)
    if place.suffix.lower() in VIDEO_SUFFIXES:
        return VideoSource(place)
    raise CameraError(
        f"{place} is no recording (.bag, .mcap, .db3), no video ({', '.join(VIDEO_SUFFIXES)}) "
        "and no folder of pictures"
    )


def _resolve(place: Path) -> Path:
    if place.exists():
        return place
    try:
        return images.path(place.as_posix())
    except (images.MissingImageError, ValueError) as error:
        raise CameraError(f"No {place} here, nor among the course's images. {error}") from error
