"""Judge what a student has cut out of a frame: where it is, and whether it is the well."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib.grading.thresholds import CROP_CLOSE, CROP_COVERED, CROP_FILLED, CROP_WHOLE

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from course_lib._validate import Image

    Rect = tuple[int, int, int, int]

# Grey levels and share of pixels: a crop may have been saved as JPEG, or its background blackened.
_SAME, _ENOUGH_SAME = 14, 0.5
_LEAST_SIDE = 12
_NEAR = 30  # pixels, for telling swapped x and y
USABLE = 0.4  # of the credit: below it another template is used for judging the rest


@dataclass(frozen=True)
class Crop:
    """A crop that was judged.

    Attributes
    ----------
    rect : (x, y, width, height) or None
        Where it was cut from the frame; None when that cannot be told.
    credit : float
        From 0 to 1.
    message : str or None
        What is wrong with it.
    """

    rect: Rect | None = field(default=None)
    credit: float = 0.0
    message: str | None = None

    @property
    def usable(self) -> bool:
        """Whether it can serve as a template."""
        return self.rect is not None and self.credit >= USABLE


def judge_crop(crop: object, frame: Image, silhouette: ArrayLike) -> Crop:
    """Judge a crop of the well.

    Parameters
    ----------
    crop : object
        What `crop_waterhole` returned.
    frame : ndarray of uint8, shape (H, W, 3)
        What it was given, BGR.
    silhouette : array_like, shape (N, 2)
        The well in the frame, (x, y).

    Returns
    -------
    Crop
    """
    if crop is None:
        return Crop(
            message="crop_waterhole should return a part of the frame. It returns None: is a "
            "return missing?"
        )
    if not isinstance(crop, np.ndarray) or crop.dtype != np.uint8 or not crop.size:
        return Crop(
            message="crop_waterhole should return a part of the frame. Is it empty? A slice is "
            "frame[y:y + h, x:x + w], rows first."
        )
    if crop.ndim != 3 or crop.shape[2] != 3:
        return Crop(message="The crop should be in colour (BGR), as the frame is.")
    rect = find_crop(crop, frame)
    if rect is None:
        mirrored = find_crop(np.ascontiguousarray(crop[..., ::-1]), frame)
        return Crop(
            message="The crop is RGB. Leave it BGR, as the frame is."
            if mirrored
            else "The crop's pixels are not those of the frame that was given. Return the slice "
            "as it is, not resized, and cut it from the argument, frame."
        )
    outline = np.asarray(silhouette, np.float64)
    (left, top), (right, bottom) = outline.min(axis=0), outline.max(axis=0) + 1
    x, y, width, height = rect
    both = max(0.0, min(x + width, right) - max(x, left)) * max(
        0.0, min(y + height, bottom) - max(y, top)
    )
    covered, filled = both / ((right - left) * (bottom - top)), both / (width * height)
    credit = max(
        _rising(filled, *CROP_FILLED) * _rising(covered, *CROP_COVERED),
        _rising(covered, *CROP_WHOLE) * _rising(filled, *CROP_CLOSE),
    )
    message = None
    if credit < 1:
        message = "The crop does not show the whole waterhole. Look at it: where is it cut off?"
        if abs(x - top) < _NEAR and abs(y - left) < _NEAR:
            message = "x and y are swapped in the crop. Rows come first: frame[y:y + h, x:x + w]."
        elif np.abs(np.subtract(rect[:2], (left, top))).max() < _NEAR and (
            np.abs(np.subtract((x + width, y + height), (right - left, bottom - top))).max() < _NEAR
        ):
            message = (
                "The crop ends where its width and height say, counted from the frame's edge. A "
                "slice names where it ends, not how long it is: frame[y:y + h, x:x + w]."
            )
        elif covered >= CROP_WHOLE[1]:
            message = (
                "The waterhole is in the crop, and much else is too. Whatever else it holds would "
                "be searched for as well: cut closer."
            )
    return Crop(rect, credit, message)


def find_crop(crop: NDArray[np.uint8], frame: Image) -> Rect | None:
    """Find where a crop was cut from a frame.

    Parameters
    ----------
    crop, frame : ndarray of uint8, shape (H, W, 3)
        BGR.

    Returns
    -------
    (x, y, width, height) or None
        None when its pixels are not the frame's.
    """
    height, width = crop.shape[:2]
    if min(height, width) < _LEAST_SIDE or height > frame.shape[0] or width > frame.shape[1]:
        return None
    for method in (cv2.TM_SQDIFF, cv2.TM_CCOEFF_NORMED):
        scores = np.nan_to_num(cv2.matchTemplate(frame, crop, method))
        _, _, lowest, highest = cv2.minMaxLoc(scores)
        x, y = lowest if method == cv2.TM_SQDIFF else highest
        there = frame[y : y + height, x : x + width].astype(np.int16)
        if (np.abs(there - crop).max(axis=2) <= _SAME).mean() >= _ENOUGH_SAME:
            return int(x), int(y), width, height
    return None


def _rising(value: float, low: float, high: float) -> float:
    """Return 0 up to ``low``, 1 from ``high`` on, smoothly rising between."""
    way = min(1.0, max(0.0, (value - low) / (high - low)))
    return way * way * (3 - 2 * way)
