"""Image encodings of `sensor_msgs` and the conversions between them, as `cv_bridge` has them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from course_lib.offline_ros.modules._cv_bridge_error import CvBridgeError

if TYPE_CHECKING:
    from numpy.typing import NDArray

_DEPTHS = {
    "8U": np.uint8,
    "8S": np.int8,
    "16U": np.uint16,
    "16S": np.int16,
    "32S": np.int32,
    "32F": np.float32,
    "64F": np.float64,
}
# Colour family, channels and depth of each named encoding.
_NAMED = {
    "mono8": ("GRAY", 1, "8U"),
    "mono16": ("GRAY", 1, "16U"),
    "bgr8": ("BGR", 3, "8U"),
    "bgr16": ("BGR", 3, "16U"),
    "rgb8": ("RGB", 3, "8U"),
    "rgb16": ("RGB", 3, "16U"),
    "bgra8": ("BGRA", 4, "8U"),
    "bgra16": ("BGRA", 4, "16U"),
    "rgba8": ("RGBA", 4, "8U"),
    "rgba16": ("RGBA", 4, "16U"),
    "bayer_rggb8": ("BayerBG", 1, "8U"),
    "bayer_bggr8": ("BayerRG", 1, "8U"),
    "bayer_gbrg8": ("BayerGR", 1, "8U"),
    "bayer_grbg8": ("BayerGB", 1, "8U"),
    "yuv422": ("YUV", 2, "8U"),
}
_GENERIC = re.compile(r"^(8U|8S|16U|16S|32S|32F|64F)C(\d+)$")


def parse(encoding: str) -> tuple[str | None, int, str]:
    """Give colour family, channel count and depth of an encoding.

    Parameters
    ----------
    encoding : str
        A colour encoding (`bgr8`, `mono16`, …) or a matrix type (`8UC3`, `32FC1`, …).

    Returns
    -------
    family : str or None
        As in OpenCV's conversion codes; None for a matrix type.
    channels : int
        Values per pixel.
    depth : str
        `8U`, `16U`, `32F`, …

    Raises
    ------
    CvBridgeError
        When it is no known encoding.
    """
    if encoding in _NAMED:
        return _NAMED[encoding]
    if match := _GENERIC.match(encoding):
        return None, int(match[2]), match[1]
    msg = (
        f"{encoding!r} is not an image encoding; use one of {', '.join(_NAMED)}, a matrix type "
        "such as 8UC3 or 32FC1, or passthrough"
    )
    raise CvBridgeError(msg)


def dtype_of(depth: str) -> np.dtype[Any]:
    """Give the NumPy type of a depth such as `8U`."""
    return np.dtype(_DEPTHS[depth])


def matrix_type(image: NDArray[Any]) -> str:
    """Give the matrix type of an array, such as `8UC3` for uint8 (H, W, 3).

    Raises
    ------
    CvBridgeError
        When OpenCV has no such type.
    """
    channels = 1 if image.ndim == 2 else image.shape[2]
    for depth, dtype in _DEPTHS.items():
        if image.dtype == dtype:
            return f"{depth}C{channels}"
    msg = f"an image of {image.dtype} has no encoding; convert it with astype(np.uint8)"
    raise CvBridgeError(msg)


def convert(image: NDArray[Any], source: str, target: str) -> NDArray[Any]:
    """Convert between two encodings.

    Parameters
    ----------
    image : ndarray (H, W) or (H, W, C)
        The picture in the source encoding.
    source, target : str
        The encodings.

    Returns
    -------
    ndarray (H, W) or (H, W, C)
        A new array in the target encoding.

    Raises
    ------
    CvBridgeError
        When there is no such conversion.
    """
    if not image.size:
        msg = "the picture has no pixels"
        raise CvBridgeError(msg)
    if source == target:
        return image.copy()
    family, channels, depth = parse(source)
    wanted, wanted_channels, wanted_depth = parse(target)
    if family is None and wanted is not None:
        msg = f"{source} does not say what its values mean, so it cannot be converted to {target}"
        raise CvBridgeError(msg)
    if wanted is None and channels != wanted_channels:
        msg = f"cannot convert {source} to {target}: it has {channels} channels"
        raise CvBridgeError(msg)
    if wanted not in {family, None}:
        name = f"YUV2{wanted}_UYVY" if family == "YUV" else f"{family}2{wanted}"
        code = getattr(cv2, f"COLOR_{name}", None)
        # cv_bridge makes no Bayer or YUV out of colours, and no transparency out of Bayer.
        possible = {"GRAY", "BGR", "RGB"}
        if not (family or "").startswith("Bayer"):
            possible |= {"BGRA", "RGBA"}
        if code is None or wanted not in possible:
            msg = f"cannot convert {source} to {target}"
            raise CvBridgeError(msg)
        image = np.asarray(cv2.cvtColor(image, code))
    return _change_depth(image, depth, wanted_depth).copy()


def _change_depth(image: NDArray[Any], depth: str, wanted: str) -> NDArray[Any]:
    if depth == wanted:
        return image
    # Full scale stays full scale: white in 8 bit is white in 16 bit.
    factor = {("8", "16"): 65535 / 255, ("16", "8"): 255 / 65535}
    values = image.astype(np.float64) * factor.get((depth[:-1], wanted[:-1]), 1.0)
    dtype = dtype_of(wanted)
    if dtype.kind in "iu":
        limits = np.iinfo(dtype)
        values = np.clip(np.rint(values), limits.min, limits.max)
    return values.astype(dtype)
