"""One place that rejects wrong input, so that every error names the argument and the fix."""

from __future__ import annotations

import math
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

Image: TypeAlias = NDArray[np.uint8]

# OpenCV stores coordinates in signed 16-bit integers while it warps and remaps.
MAX_SIDE = 32_767


def as_image(image: object, name: str) -> Image:
    """
    Check a picture and bring it to uint8, grey ``(H, W)`` or BGR ``(H, W, 3)``.

    Parameters
    ----------
    image : ndarray, shape (H, W), (H, W, 1), (H, W, 3) or (H, W, 4)
        uint8; bool (False is black, True is white); or float, in 0..1 as matplotlib and
        scikit-image keep it, or in 0..255. A float picture with no value above 1 is taken to be
        in 0..1. A fourth channel (alpha) is dropped.
    name : str
        The argument's name, for the error message.

    Returns
    -------
    ndarray of uint8, shape (H, W) or (H, W, 3), C-contiguous
        The caller's own array when nothing had to change.

    Raises
    ------
    TypeError
        Not an array, or of a dtype that is none of the above.
    ValueError
        Empty, of a wrong shape, too large, or with values out of range.
    """
    if image is None:
        raise TypeError(
            f"{name} is None: was the file found? cv2.imread returns None when it cannot read one"
        )
    if not isinstance(image, np.ndarray):
        raise TypeError(f"{name} must be a NumPy array, got {type(image).__name__}")
    if image.ndim == 3 and image.shape[2] == 1:
        image = image[:, :, 0]
    if image.ndim not in (2, 3) or (image.ndim == 3 and image.shape[2] not in (3, 4)):
        raise ValueError(
            f"{name} must be grey (H, W) or colour (H, W, 3) or (H, W, 4), got shape {image.shape}"
        )
    if image.size == 0:
        raise ValueError(f"{name} is empty: shape {image.shape}. Is a crop's slice out of range?")
    if max(image.shape[:2]) > MAX_SIDE:
        raise ValueError(
            f"{name} is {image.shape[1]} x {image.shape[0]} pixels; OpenCV handles sides up to "
            f"{MAX_SIDE}. Shrink it first, for example with images.resize"
        )
    if image.ndim == 3 and image.shape[2] == 4:
        image = image[:, :, :3]
    return np.ascontiguousarray(_as_uint8(image, name))


def _as_uint8(image: NDArray[np.generic], name: str) -> Image:
    if image.dtype == np.uint8:
        return image.astype(np.uint8, copy=False)
    if image.dtype == np.bool_:
        return image.astype(np.uint8) * np.uint8(255)
    if not np.issubdtype(image.dtype, np.floating):
        hint = " (16 bit: divide by 256 first)" if image.dtype.itemsize == 2 else ""
        raise TypeError(f"{name} must be uint8 or float, got {image.dtype}{hint}")
    # The extremes alone tell NaN, infinity and range, without a mask as large as the picture.
    low, high = float(np.min(image)), float(np.max(image))
    if not (math.isfinite(low) and math.isfinite(high)):
        raise ValueError(f"{name} holds NaN or infinity; numpy.nan_to_num removes them")
    if low < 0 or high > 255:
        raise ValueError(
            f"{name} is float with values {low:g}..{high:g}; expected 0..1 or 0..255. "
            "Rescale it, for example with cv2.normalize"
        )
    scale = 255.0 if high <= 1 else 1.0
    grown = np.multiply(image, scale, dtype=np.float32, casting="unsafe")
    return np.asarray(np.rint(grown, out=grown), np.uint8)


def as_grey(image: object, name: str) -> Image:
    """Return ``as_image(image, name)`` as grey uint8 (H, W), through ``COLOR_BGR2GRAY``."""
    checked = as_image(image, name)
    if checked.ndim == 2:
        return checked
    return cv2.cvtColor(checked, cv2.COLOR_BGR2GRAY).astype(np.uint8, copy=False)


def as_bgr(image: object, name: str) -> Image:
    """Return ``as_image(image, name)`` as a BGR uint8 (H, W, 3) copy that may be drawn upon."""
    checked = as_image(image, name)
    if checked.ndim == 2:
        return cv2.cvtColor(checked, cv2.COLOR_GRAY2BGR).astype(np.uint8, copy=False)
    return checked.copy()


def as_corners(corners: ArrayLike, name: str) -> NDArray[np.float64]:
    """
    Check four corners of an outline.

    Parameters
    ----------
    corners : array_like, shape (4, 2) or OpenCV's (4, 1, 2)
        Points (x, y).
    name : str
        The argument's name, for the error message.

    Returns
    -------
    ndarray of float64, shape (4, 2)

    Raises
    ------
    ValueError
        Another shape, or a coordinate that is NaN or infinite.
    """
    points = np.asarray(corners, dtype=np.float64)
    if points.shape not in ((4, 2), (4, 1, 2)):
        raise ValueError(f"{name} must have shape (4, 2), got {points.shape}")
    if not np.isfinite(points).all():
        raise ValueError(f"{name} holds NaN or infinity")
    return points.reshape(4, 2)


def as_count(value: object, name: str, minimum: int) -> int:
    """Check that ``value`` is a whole number of at least ``minimum``, and return it as int."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError(f"{name} must be a whole number, got {value!r}")
    if value < minimum:
        raise ValueError(f"{name} must be at least {minimum}, got {value}")
    return int(value)
