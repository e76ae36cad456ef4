"""Tell a plot from a photograph in what a notebook drew."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib.grading.published_flight import background_colour

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_lib._validate import Image

# Pixels; curves drawn in the thinnest lines still show.
_WIDTH = 480
# Axes side by side do not belong together; points without axes do, far apart as they are.
_REACHES = (5, 41)
_STANDS_OUT = 40  # grey levels
_LEAST_SIDES = (0.2, 0.2)  # of the picture's width and height
# A plot has few colours, whatever they are; photographs have hundreds.
_COLOURS, _FEW_COLOURS = 32, 0.9
_LEAST_INK = 0.002


def shows_plot(picture: Image) -> bool:
    """Tell whether a picture holds a plot: axes, curves, points or bars on a plain ground.

    Parameters
    ----------
    picture : ndarray of uint8, shape (height, width, 3)
        What was drawn, BGR.
    """
    scale = min(1.0, _WIDTH / picture.shape[1])
    # A strip one pixel high stays one pixel high.
    size = [max(1, round(side * scale)) for side in picture.shape[1::-1]]
    small = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)
    height, width = small.shape[:2]
    ground = background_colour(small)
    ink = (np.abs(small.astype(np.int16) - ground).max(axis=2) > _STANDS_OUT).astype(np.uint8)
    for left, top, w, h in _groups(ink):
        if w < _LEAST_SIDES[0] * width or h < _LEAST_SIDES[1] * height:
            continue
        share = float(ink[top : top + h, left : left + w].mean())
        part = small[top : top + h, left : left + w]
        if share > _LEAST_INK and _has_few_colours(part):
            return True
    return False


def _groups(ink: Image) -> Iterator[tuple[int, int, int, int]]:
    """Yield left, top, width, height of what belongs together."""
    for reach in _REACHES:
        joined = cv2.dilate(ink, np.ones((reach, reach), np.uint8))
        count, _, stats, _ = cv2.connectedComponentsWithStats(joined)
        for left, top, w, h, _ in stats[1:count]:
            yield int(left), int(top), int(w), int(h)


def _has_few_colours(part: Image) -> bool:
    codes = (part >> 4).astype(np.int32) @ np.array([256, 16, 1], np.int32)
    counts = np.sort(np.bincount(codes.ravel()))[::-1]
    return bool(counts[:_COLOURS].sum() >= _FEW_COLOURS * counts.sum())
