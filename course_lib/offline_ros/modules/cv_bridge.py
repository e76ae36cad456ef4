"""`cv_bridge`: ROS image messages to OpenCV pictures and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.modules._cv_bridge_error import CvBridgeError
from course_lib.offline_ros.modules._encodings import convert, dtype_of, matrix_type, parse

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["CvBridge", "CvBridgeError"]

_FORMATS = ("bmp", "dib", "jpe", "jpeg", "jpg", "pgm", "png", "ppm", "tif", "tiff", "webp")


class CvBridge:
    """Converts between `sensor_msgs` images and NumPy arrays."""

    def imgmsg_to_cv2(
        self,
        img_msg: Any,  # noqa: ANN401  (sensor_msgs/Image)
        desired_encoding: str = "passthrough",
    ) -> NDArray[Any]:
        """Turn a `sensor_msgs/Image` into an array.

        Parameters
        ----------
        img_msg : sensor_msgs/Image
            The message.
        desired_encoding : str, optional
            Such as `bgr8` or `mono8`. Default: as it came, and then read-only.

        Returns
        -------
        ndarray (H, W) or (H, W, C)
            The picture.

        Raises
        ------
        CvBridgeError
            When the message is inconsistent or cannot be converted.
        """
        if not all(hasattr(img_msg, name) for name in ("encoding", "step", "height", "data")):
            msg = f"imgmsg_to_cv2 takes a sensor_msgs/Image, not {_kind(img_msg)}"
            raise CvBridgeError(msg)
        _, channels, depth = parse(img_msg.encoding)
        dtype = dtype_of(depth).newbyteorder(">" if img_msg.is_bigendian else "<")
        height, width, step = img_msg.height, img_msg.width, img_msg.step
        row = width * channels * dtype.itemsize
        if step < row or len(img_msg.data) < step * (height - 1) + row:
            msg = (
                f"the message says {width}x{height} {img_msg.encoding} with {step} bytes per row, "
                f"but holds {len(img_msg.data)} bytes"
            )
            raise CvBridgeError(msg)
        image: NDArray[Any] = np.ndarray(
            shape=(height, width) if channels == 1 else (height, width, channels),
            dtype=dtype,
            buffer=bytes(img_msg.data),
            strides=(step, channels * dtype.itemsize, dtype.itemsize)[: 2 + (channels > 1)],
        )
        if not dtype.isnative:
            image = image.astype(dtype.newbyteorder("="))
        if desired_encoding == "passthrough":
            return image
        return convert(image, img_msg.encoding, desired_encoding)

    def cv2_to_imgmsg(
        self,
        cvim: NDArray[Any],
        encoding: str = "passthrough",
        header: Any = None,  # noqa: ANN401  (std_msgs/Header)
    ) -> Any:  # noqa: ANN401  (sensor_msgs/Image)
        """Turn an array into a `sensor_msgs/Image`.

        Parameters
        ----------
        cvim : ndarray (H, W) or (H, W, C)
            The picture.
        encoding : str, optional
            What the array holds, such as `bgr8`; nothing is converted. Default: its matrix type.
        header : std_msgs/Header, optional
            Stamp and frame of the message.

        Returns
        -------
        sensor_msgs/Image
            The message.

        Raises
        ------
        TypeError
            When it is no picture.
        CvBridgeError
            When the array does not hold that encoding.
        """
        _check_array(cvim)
        kind = matrix_type(cvim)
        if encoding == "passthrough":
            encoding = kind
        else:
            _, channels, depth = parse(encoding)
            if kind != f"{depth}C{channels}":
                msg = (
                    f"encoding specified as {encoding}, but the image is {kind}, "
                    f"not {depth}C{channels}"
                )
                raise CvBridgeError(msg)
        message = message_class("sensor_msgs/Image")(
            height=cvim.shape[0],
            width=cvim.shape[1],
            encoding=encoding,
            is_bigendian=int(cvim.dtype.byteorder == ">"),
            data=cvim.tobytes(),
        )
        message.step = len(message.data) // message.height if message.height else 0
        if header is not None:
            message.header = header
        return message

    def compressed_imgmsg_to_cv2(
        self,
        cmprs_img_msg: Any,  # noqa: ANN401  (sensor_msgs/CompressedImage)
        desired_encoding: str = "passthrough",
    ) -> NDArray[Any]:
        """Turn a `sensor_msgs/CompressedImage` into an array.

        Parameters
        ----------
        cmprs_img_msg : sensor_msgs/CompressedImage
            JPEG, PNG or another format OpenCV reads.
        desired_encoding : str, optional
            Default: as it is stored, in BGR order where it has colours.

        Returns
        -------
        ndarray (H, W) or (H, W, C)
            The picture.

        Raises
        ------
        CvBridgeError
            When the data is no picture or cannot be converted.
        """
        if not hasattr(cmprs_img_msg, "format"):
            msg = (
                "compressed_imgmsg_to_cv2 takes a sensor_msgs/CompressedImage, "
                f"not {_kind(cmprs_img_msg)}"
            )
            raise CvBridgeError(msg)
        data = np.frombuffer(bytes(cmprs_img_msg.data), np.uint8)
        image = cv2.imdecode(data, cv2.IMREAD_ANYCOLOR) if data.size else None
        if image is None:
            msg = f"the {len(data)} bytes of format {cmprs_img_msg.format!r} are no picture"
            raise CvBridgeError(msg)
        if desired_encoding == "passthrough":
            return np.asarray(image)
        return convert(np.asarray(image), "mono8" if image.ndim == 2 else "bgr8", desired_encoding)

    def cv2_to_compressed_imgmsg(
        self,
        cvim: NDArray[Any],
        dst_format: str = "jpg",
    ) -> Any:  # noqa: ANN401  (sensor_msgs/CompressedImage)
        """Turn an array (grey, BGR or BGRA) into a `sensor_msgs/CompressedImage`.

        Parameters
        ----------
        cvim : ndarray (H, W) or (H, W, C)
            The picture.
        dst_format : str, optional
            jpg, png, bmp, tiff, webp or another of OpenCV's.

        Returns
        -------
        sensor_msgs/CompressedImage
            The message.

        Raises
        ------
        TypeError
            When it is no picture.
        CvBridgeError
            When OpenCV cannot write it so.
        """
        _check_array(cvim)
        if dst_format not in _FORMATS:
            msg = f"unknown format {dst_format!r}; use one of {', '.join(_FORMATS)}"
            raise CvBridgeError(msg)
        try:
            written, data = cv2.imencode(f".{dst_format}", cvim)
        except cv2.error as error:
            msg = f"OpenCV cannot write this {matrix_type(cvim)} image as {dst_format}: {error}"
            raise CvBridgeError(msg) from error
        if not written:
            msg = f"OpenCV cannot write this {matrix_type(cvim)} image as {dst_format}"
            raise CvBridgeError(msg)
        return message_class("sensor_msgs/CompressedImage")(format=dst_format, data=data.tobytes())

    def encoding_to_dtype_with_channels(self, encoding: str) -> tuple[str, int]:
        """Give NumPy type name and channel count of an encoding."""
        _, channels, depth = parse(encoding)
        return dtype_of(depth).name, channels


def _kind(value: object) -> str:
    return str(getattr(value, "_type", type(value).__name__))


def _check_array(value: object) -> None:
    if not isinstance(value, np.ndarray):
        msg = f"a picture is a numpy array, not {type(value).__name__}"
        if value is None:
            msg += ": was it read from a file that does not exist?"
        raise TypeError(msg)
    if value.ndim not in {2, 3} or not value.size:
        msg = f"a picture has shape (H, W) or (H, W, C), not {value.shape}"
        raise TypeError(msg)
