"""The BRIEF viewer: the pairs of pixels, the bits of two patches, and their Hamming distance."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import cv2
import ipywidgets
import numpy as np
from traitlets import Bytes, Int, Unicode

from course_lib.brief import GEOMETRIES, sampling_pairs
from course_lib.explore._base import (
    Canvas,
    Viewer,
    colour_picture,
    jpeg,
    link,
    module,
    slider,
)
from course_lib.explore._still import caption
from course_lib.segment_test import is_maximum, score_map

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

PATCH = 31
HALF = PATCH // 2
SIZES = (16, 32, 64)  # bytes
SIGMAS = (0.0, 1.0, 2.0, 3.0)
N_POINTS = 12
MAP_WIDTH, PANEL, GAP = 260, 232, 16


class BriefCanvas(Canvas):
    """Two patches, the tests upon them and the bits that result."""

    _esm = module("brief")

    geometry = Int().tag(sync=True)
    size = Int().tag(sync=True)
    smoothing = Int().tag(sync=True)
    first = Int().tag(sync=True)
    second = Int().tag(sync=True)
    pairs = Bytes().tag(sync=True)
    patches = Bytes().tag(sync=True)
    about = Unicode().tag(sync=True)


def brief_pairs(
    image: NDArray[np.uint8],
    other: NDArray[np.uint8] | None = None,
    *,
    points: Sequence[tuple[int, int]] | None = None,
    seed: int = 0,
    alt: str | None = None,
) -> Viewer:
    """Compare the BRIEF descriptors of two points, bit by bit.

    Parameters
    ----------
    image
        Picture, BGR or grey uint8 of shape (height, width[, 3]), in which point A lies.
    other
        Picture of the same size in which point B lies, such as a noisy view of the same scene;
        by default `image` itself.
    points
        Pixels (x, y) to choose from, at least 15 pixels from the border; by default the strongest
        FAST corners that keep their distance from each other.
    seed
        Of the sampling pairs.
    alt
        Text alternative of the viewer.

    Returns
    -------
    Viewer
        Controls for geometry, descriptor size, smoothing and the two points, and the canvas.

    Raises
    ------
    TypeError, ValueError
        When an input is no picture, the pictures differ in size, or no point can be used.

    References
    ----------
    Calonder, Lepetit, Strecha and Fua, "BRIEF: Binary Robust Independent Elementary Features",
    ECCV 2010.
    """
    picture = colour_picture(image)
    second = picture if other is None else colour_picture(other, "other")
    if picture.shape != second.shape:
        raise ValueError(f"image and other must be of one size: {picture.shape}, {second.shape}")
    greys = [np.asarray(cv2.cvtColor(p, cv2.COLOR_BGR2GRAY), np.uint8) for p in (picture, second)]
    chosen = _spread_corners(greys[0]) if points is None else [(int(x), int(y)) for x, y in points]
    height, width = greys[0].shape
    for x, y in chosen:
        if not (HALF <= x < width - HALF and HALF <= y < height - HALF):
            raise ValueError(f"point ({x}, {y}) is nearer than {HALF} pixels to the border")
    if not chosen:
        raise ValueError("no point to describe: the picture has no FAST corner away from its edge")

    patches = np.stack([_patches(grey, chosen) for grey in greys])
    pairs = np.stack([sampling_pairs(g, 8 * SIZES[-1], PATCH, seed=seed) for g in GEOMETRIES])
    distance = _distance(patches, pairs[1], 256)
    alt = alt or (
        "BRIEF's pixel pairs over the patches of two points, with their bits; geometry G II, "
        f"256 tests, smoothing 2: Hamming distance {distance} of 256."
    )
    map_height = round(height * MAP_WIDTH / width)
    canvas = BriefCanvas(
        picture=jpeg(picture),
        width=MAP_WIDTH + 2 * (GAP + PANEL),
        height=max(map_height, PANEL + 96),
        geometry=1,
        size=1,
        smoothing=2,
        first=1,
        second=1,
        pairs=pairs.astype(np.int8).tobytes(),
        patches=patches.tobytes(),
        about=json.dumps(
            {
                "points": chosen,
                "columns": width,
                "map": [MAP_WIDTH, map_height],
                "panel": PANEL,
                "gap": GAP,
                "patch": PATCH,
                "sizes": SIZES,
                "sigmas": SIGMAS,
                "tests": 8 * SIZES[-1],
                "names": GEOMETRIES,
                "same": other is None,
            }
        ),
        alt=alt,
    )
    still = caption(_draw(patches, pairs[1]), f"{alt} Run the notebook to change them.")
    return Viewer([*_controls(canvas, len(chosen)), canvas], still=still, alt=alt)


def _controls(canvas: BriefCanvas, count: int) -> list[ipywidgets.Widget]:
    style = {"description_width": "initial"}
    controls: list[ipywidgets.Widget] = []
    for label, trait, options in (
        ("geometry", "geometry", list(GEOMETRIES)),
        ("descriptor", "size", [f"{8 * size} tests = {size} bytes" for size in SIZES]),
        ("smoothing", "smoothing", [f"sigma {sigma:g}" for sigma in SIGMAS]),
    ):
        choice = ipywidgets.Dropdown(
            options=options, index=getattr(canvas, trait), description=label, style=style
        )
        link(choice, canvas, trait, attribute="index")
        controls.append(choice)
    for label, trait in (("point A", "first"), ("point B", "second")):
        control = slider(label, 1, 1, count)
        link(control, canvas, trait)
        controls.append(control)
    return controls


def _spread_corners(grey: NDArray[np.uint8]) -> list[tuple[int, int]]:
    scores = score_map(grey)
    scores[:HALF], scores[-HALF:], scores[:, :HALF], scores[:, -HALF:] = 0, 0, 0, 0
    scores = np.where(is_maximum(scores), scores, 0).astype(np.uint8)
    chosen: list[tuple[int, int]] = []
    keep_away = max(grey.shape) // 8
    while len(chosen) < N_POINTS and scores.any():
        y, x = (int(v) for v in np.unravel_index(int(scores.argmax()), scores.shape))
        chosen.append((x, y))
        cv2.circle(scores, (x, y), keep_away, 0, -1)
    return chosen


def _patches(grey: NDArray[np.uint8], points: Sequence[tuple[int, int]]) -> NDArray[np.uint8]:
    """Cut every point's patch out of every smoothed picture: (sigma, point, row, column)."""
    smoothed = [cv2.GaussianBlur(grey, (0, 0), s) if s else grey for s in SIGMAS]
    rows = [
        [g[y - HALF : y + HALF + 1, x - HALF : x + HALF + 1] for x, y in points] for g in smoothed
    ]
    return np.array(rows, np.uint8)


def _bits(patch: NDArray[np.uint8], pairs: NDArray[np.int32]) -> NDArray[np.bool_]:
    x1, y1, x2, y2 = (pairs + HALF).T
    return np.asarray(patch[y1, x1] < patch[y2, x2], np.bool_)


def _distance(patches: NDArray[np.uint8], pairs: NDArray[np.int32], tests: int) -> int:
    a, b = (_bits(side[2, 0], pairs[:tests]) for side in patches)
    return int(np.count_nonzero(a != b))


def _draw(patches: NDArray[np.uint8], pairs: NDArray[np.int32]) -> NDArray[np.uint8]:
    zoom, shown = 9, 64
    parts = []
    for side in patches:
        big = cv2.resize(side[2, 0], None, fx=zoom, fy=zoom, interpolation=cv2.INTER_NEAREST)
        still = np.asarray(cv2.cvtColor(big, cv2.COLOR_GRAY2BGR), np.uint8)
        for (x1, y1, x2, y2), bit in zip(pairs[:shown], _bits(side[2, 0], pairs), strict=False):
            start = (int(x1 + HALF) * zoom + zoom // 2, int(y1 + HALF) * zoom + zoom // 2)
            end = (int(x2 + HALF) * zoom + zoom // 2, int(y2 + HALF) * zoom + zoom // 2)
            cv2.line(still, start, end, (0, 165, 255) if bit else (255, 120, 30), 1, cv2.LINE_AA)
        parts.append(still)
    gap = np.full((parts[0].shape[0], 24, 3), 255, np.uint8)
    return np.hstack([parts[0], gap, parts[1]])
