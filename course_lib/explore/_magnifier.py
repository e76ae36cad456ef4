"""The magnifier: FAST's segment test at one pixel, circle by circle pixel."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import cv2
import ipywidgets
import numpy as np
from traitlets import Bytes, Int, Unicode

from course_lib.explore._base import (
    Canvas,
    Viewer,
    colour_picture,
    jpeg,
    link,
    module,
    slider,
)
from course_lib.explore._fast import ranked
from course_lib.explore._still import caption
from course_lib.segment_test import CIRCLE, is_maximum, longest_arc, score_map, signs

if TYPE_CHECKING:
    from numpy.typing import NDArray

PANEL = 330  # CSS pixels, the side of the magnified patch
REACH = 5  # the patch shows this many pixels around its centre
MAP_WIDTH = 400
ARCS = (9, 12)  # lengths to choose from, in the canvas's order of choice
BRIGHTER_BGR, DARKER_BGR, SIMILAR_BGR = (0, 165, 255), (255, 120, 30), (160, 160, 160)


class MagnifierCanvas(Canvas):
    """A picture to point at, and beside it the sixteen circle pixels of the point."""

    _esm = module("magnifier")

    threshold = Int().tag(sync=True)
    choice = Int().tag(sync=True)
    x = Int().tag(sync=True)
    y = Int().tag(sync=True)
    grey = Bytes().tag(sync=True)
    about = Unicode().tag(sync=True)
    kept9_points = Bytes().tag(sync=True)
    kept9_scores = Bytes().tag(sync=True)
    kept12_points = Bytes().tag(sync=True)
    kept12_scores = Bytes().tag(sync=True)


def fast_magnifier(
    image: NDArray[np.uint8],
    *,
    threshold: int = 20,
    point: tuple[int, int] | None = None,
    alt: str | None = None,
) -> Viewer:
    """Show the segment test at the pixel under the pointer.

    The 16 circle pixels are marked brighter, darker or similar, the longest arc is joined, and
    the verdict says why the pixel is a corner or is not. Dots mark the corners, and the pointer
    snaps to one that is near. A click holds the point, a click on it lets go; a click on the
    magnified patch, or an arrow key, moves by single pixels.

    Parameters
    ----------
    image
        Picture, BGR or grey uint8 of shape (height, width[, 3]), at least 16 pixels wide and high.
    threshold
        Threshold shown first, in grey levels.
    point
        Pixel (x, y) shown first; by default the strongest corner.
    alt
        Text alternative of the viewer.

    Returns
    -------
    Viewer
        Slider, choice of the arc's length and canvas.

    Raises
    ------
    TypeError, ValueError
        When `image` is no picture or too small, `threshold` is outside 1 … 255, or `point` lies
        outside the picture.

    References
    ----------
    Rosten and Drummond, "Machine learning for high-speed corner detection", ECCV 2006.
    """
    picture = colour_picture(image)
    height, width = picture.shape[:2]
    if min(height, width) < 16:
        raise ValueError(f"image must be at least 16 pixels wide and high, not {width} x {height}")
    grey = np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.uint8)
    if not 1 <= threshold <= 255:
        raise ValueError(f"threshold must be a grey level from 1 to 255, not {threshold}")
    kept = {}
    for n in ARCS:
        scores = score_map(grey, n)
        kept[n] = np.where(is_maximum(scores), scores, 0).astype(np.uint8)
    if point is None:
        best = kept[9]
        row, column = np.unravel_index(int(best.argmax()), best.shape)
        point = (int(column), int(row))
    x, y = point
    if not (0 <= x < width and 0 <= y < height):
        raise ValueError(f"point {point} lies outside the picture of {width} x {height} pixels")

    scale = MAP_WIDTH / width
    map_height = round(height * scale)
    text = verdict(grey, x, y, threshold)
    alt = alt or f"FAST's circle of 16 pixels around ({x}, {y}), magnified: {text}."
    canvas = MagnifierCanvas(
        picture=jpeg(picture),
        width=MAP_WIDTH + 20 + PANEL,
        height=max(map_height, PANEL),
        threshold=threshold,
        choice=0,
        x=x,
        y=y,
        grey=np.ascontiguousarray(grey).tobytes(),
        about=json.dumps(
            {
                "columns": width,
                "rows": height,
                "map": [MAP_WIDTH, map_height],
                "panel": PANEL,
                "reach": REACH,
                "circle": CIRCLE,
            }
        ),
        alt=alt,
        **ranked("kept9", kept[9]),
        **ranked("kept12", kept[12]),
    )
    control = slider("threshold", threshold, 1, max(150, threshold))
    link(control, canvas, "threshold")
    arc = ipywidgets.Dropdown(
        options=[(f"{n} contiguous (FAST-{n})", n) for n in ARCS],
        value=9,
        description="corner means",
        style={"description_width": "initial"},
    )
    # The browser knows an option by its place only.
    link(arc, canvas, "choice", attribute="index")
    label = f"{text}. Run the notebook to point at other pixels."
    still = caption(_draw(grey, x, y, threshold), label)
    return Viewer([control, arc, canvas], still=still, alt=alt)


def verdict(grey: NDArray[np.uint8], x: int, y: int, threshold: int, n: int = 9) -> str:
    """Say in a sentence what the segment test finds at a pixel."""
    length, _, sign = longest_arc(signs(grey, x, y, threshold))
    word = {1: "brighter", -1: "darker", 0: "different"}[sign]
    outcome = "a corner" if length >= n else "no corner"
    return f"({x}, {y}) is {outcome}: {length} contiguous {word}, needs {n}"


def _draw(grey: NDArray[np.uint8], x: int, y: int, threshold: int) -> NDArray[np.uint8]:
    cell = PANEL // (2 * REACH + 1)
    padded = cv2.copyMakeBorder(grey, REACH, REACH, REACH, REACH, cv2.BORDER_CONSTANT, value=0)
    patch = padded[y : y + 2 * REACH + 1, x : x + 2 * REACH + 1]
    side = cell * patch.shape[0]
    big = cv2.resize(patch, (side, side), interpolation=cv2.INTER_NEAREST)
    still = np.asarray(cv2.cvtColor(big, cv2.COLOR_GRAY2BGR), np.uint8)
    inks = {1: BRIGHTER_BGR, -1: DARKER_BGR, 0: SIMILAR_BGR}
    for (dx, dy), state in zip(CIRCLE, signs(grey, x, y, threshold), strict=True):
        corner = ((dx + REACH) * cell, (dy + REACH) * cell)
        opposite = (corner[0] + cell - 1, corner[1] + cell - 1)
        cv2.rectangle(still, corner, opposite, inks[state], 3 if state else 1)
    centre = (REACH * cell, REACH * cell)
    cv2.rectangle(still, centre, (centre[0] + cell, centre[1] + cell), (255, 255, 255), 2)
    return np.asarray(cv2.copyMakeBorder(still, 0, 0, 0, 270, cv2.BORDER_CONSTANT,
                                         value=(255, 255, 255)), np.uint8)  # fmt: skip
