"""ROS image messages to BGR arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from course_lib.camera.frames import CameraError

if TYPE_CHECKING:
    from course_lib._validate import Image

# Encoding: channels, and the conversion to BGR (None: BGR already). The names are those of
# sensor_msgs/image_encodings.h; 8UCn is what cv_bridge writes for an untyped OpenCV matrix.
ENCODINGS: dict[str, tuple[int, int | None]] = {
    "bgr8": (3, None),
    "8UC3": (3, None),
    "rgb8": (3, cv2.COLOR_RGB2BGR),
    "bgra8": (4, cv2.COLOR_BGRA2BGR),
    "8UC4": (4, cv2.COLOR_BGRA2BGR),
    "rgba8": (4, cv2.COLOR_RGBA2BGR),
    "mono8": (1, cv2.COLOR_GRAY2BGR),
    "8UC1": (1, cv2.COLOR_GRAY2BGR),
}


def decode_image(message: Any) -> Image:  # noqa: ANN401 (rosbags makes the type at run time)
    """
    Decode a raw ``sensor_msgs/Image``.

    Parameters
    ----------
    message : object
        With ``height``, ``width``, ``encoding``, ``step`` (bytes in a row, which may end in
        padding) and ``data``.

    Returns
    -------
    ndarray of uint8, shape (height, width, 3)
        BGR.

    Raises
    ------
    CameraError
        An encoding other than 8-bit colour or grey, or sizes that contradict each other.
    """
    encoding, height, width = str(message.encoding), int(message.height), int(message.width)
    if encoding not in ENCODINGS:
        order = "big" if message.is_bigendian else "little"
        deep = f" (16 bits per pixel, {order}-endian)" if "16" in encoding else ""
        raise CameraError(
            f"encoding {encoding!r}{deep} is not supported; convert the topic to one of "
            f"{', '.join(ENCODINGS)}"
        )
    channels, conversion = ENCODINGS[encoding]
    step = int(message.step) or width * channels
    data = np.frombuffer(message.data, np.uint8)
    if height < 1 or width < 1 or step < width * channels or data.size < step * height:
        raise CameraError(
            f"damaged image message: {data.size} bytes, {width} x {height} {encoding}, step {step}"
        )
    rows = data[: step * height].reshape(height, step)[:, : width * channels]
    picture = np.ascontiguousarray(rows).reshape(height, width, channels)
    if conversion is None:
        # A frame belongs to its reader: it must not be a view of the message's read-only bytes.
        return picture if picture.flags.owndata and picture.flags.writeable else picture.copy()
    return cv2.cvtColor(picture, conversion).astype(np.uint8, copy=False)


def decode_compressed(message: Any) -> Image:  # noqa: ANN401 (rosbags makes the type at run time)
    """
    Decode a ``sensor_msgs/CompressedImage`` (JPEG or PNG).

    Parameters
    ----------
    message : object
        With ``format`` and ``data``.

    Returns
    -------
    ndarray of uint8, shape (H, W, 3)
        BGR.

    Raises
    ------
    CameraError
        A depth image, or damaged data.
    """
    form = str(message.format)
    if "compresseddepth" in form.lower():
        raise CameraError(f"format {form!r} is a depth image, not a picture")
    data = np.frombuffer(message.data, np.uint8)
    picture = cv2.imdecode(data, cv2.IMREAD_COLOR_BGR) if data.size else None
    if picture is None:
        raise CameraError(f"damaged compressed image: {data.size} bytes, format {form!r}")
    return picture.astype(np.uint8, copy=False)
