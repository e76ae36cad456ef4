"""FAST's segment test: the sixteen circle pixels, the longest arc, the score of a corner.

References
----------
Rosten and Drummond, "Machine learning for high-speed corner detection", ECCV 2006.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Bresenham circle of radius 3, clockwise from the top: (x, y).
CIRCLE = (
    *((0, -3), (1, -3), (2, -2), (3, -1), (3, 0), (3, 1), (2, 2), (1, 3)),
    *((0, 3), (-1, 3), (-2, 2), (-3, 1), (-3, 0), (-3, -1), (-2, -2), (-1, -3)),
)


def signs(grey: NDArray[np.uint8], x: int, y: int, threshold: int) -> list[int]:
    """Tell each circle pixel's state: 1 brighter, -1 darker, 0 similar or outside the picture."""
    height, width = grey.shape
    states = []
    for dx, dy in CIRCLE:
        inside = 0 <= x + dx < width and 0 <= y + dy < height
        difference = int(grey[y + dy, x + dx]) - int(grey[y, x]) if inside else 0
        states.append(int(difference > threshold) - int(difference < -threshold))
    return states


def longest_arc(states: list[int]) -> tuple[int, int, int]:
    """Return (length, first place, sign) of the longest run round the circle; length 0: none."""
    best = (0, 0, 0)
    for sign in (1, -1):
        for start in range(16):
            length = 0
            while length < 16 and states[(start + length) % 16] == sign:
                length += 1
            best = max(best, (length, start, sign), key=lambda run: run[0])
    return best


def score_map(grey: NDArray[np.uint8], n: int = 9) -> NDArray[np.uint8]:
    """Give every pixel its FAST score, 0 where it is no corner even at threshold 1.

    The segment test asks for `n` contiguous circle pixels all brighter, or all darker, than the
    centre by more than the threshold. The highest threshold that an arc passes is one less than
    its smallest difference; a pixel's score is that of its best arc.

    Parameters
    ----------
    grey
        Grey picture, uint8 of shape (height, width).
    n
        Length of the arc.

    Returns
    -------
    uint8 array of shape (height, width); the outer three pixels are always 0.
    """
    scores = np.zeros(grey.shape, np.uint8)
    height, width = grey.shape
    if min(height, width) < 7:
        return scores
    centre = grey[3:-3, 3:-3].astype(np.int16)
    differences = [
        grey[3 + y : height - 3 + y, 3 + x : width - 3 + x].astype(np.int16) - centre
        for x, y in CIRCLE
    ]
    best = np.zeros_like(centre)
    for sign in (1, -1):
        signed = [sign * difference for difference in differences]
        for start in range(16):
            arc = signed[start]
            for step in range(1, n):
                arc = np.minimum(arc, signed[(start + step) % 16])
            np.maximum(best, arc - 1, out=best)
    scores[3:-3, 3:-3] = best
    return scores


def is_maximum(scores: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Tell which pixels score strictly more than all eight neighbours.

    Neighbours below a threshold lose against a corner above it anyway, so the suppressed set at
    any threshold is this one set, filtered.
    """
    ring = np.ones((3, 3), np.uint8)
    ring[1, 1] = 0
    return np.asarray(scores > cv2.dilate(scores, ring, borderValue=0), np.bool_)
