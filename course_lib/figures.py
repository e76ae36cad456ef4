"""Figures of the theory: the ring of FAST, what makes a corner, where BRIEF looks.

Each function returns a matplotlib ``Figure``; ``drawing.plot(figure, alt=...)`` shows it.
Figures are made without pyplot, so nothing stays open and no backend matters.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from course_lib.segment_test import CIRCLE, longest_arc, signs

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["look_around", "ring", "sampling", "typical_points", "unrolled"]

BRIGHTER, DARKER, SIMILAR, CENTRE = "#f2b134", "#2b4c7e", "#c9ccd1", "#c0392b"
MARGIN = 20


def typical_points(gray: NDArray[np.uint8]) -> dict[str, tuple[int, int]]:
    """Find the flattest, the most edge-like and the most corner-like point of a picture.

    The eigenvalues of the structure tensor tell them apart: both small where nothing
    happens, one large on an edge, both large at a corner [1]_. Among such places those are
    taken on which FAST's ring shows nothing, half a ring, or a corner's arc.

    Parameters
    ----------
    gray : uint8, shape (h, w)
        Grey picture, at least 64 pixels each way.

    Returns
    -------
    dict
        ``"flat"``, ``"edge"`` and ``"corner"``, each a pixel (x, y) at least 20 pixels from
        the border.

    Raises
    ------
    ValueError
        If `gray` is not a grey uint8 picture of 64 pixels or more each way.

    References
    ----------
    .. [1] C. Harris, M. Stephens, "A Combined Corner and Edge Detector", Alvey Vision
       Conference 1988.
    """
    if gray.ndim != 2 or gray.dtype != np.uint8 or min(gray.shape) < 64:
        msg = f"gray must be a uint8 picture (h, w) of 64 pixels or more, not {gray.shape}"
        raise ValueError(msg)
    vectors = cv2.cornerEigenValsAndVecs(cv2.GaussianBlur(gray, (0, 0), 1.0), 7, 3)
    inside = np.s_[MARGIN:-MARGIN, MARGIN:-MARGIN]
    eigenvalues = vectors[inside][..., :2]
    large, small = eigenvalues.max(-1), eigenvalues.min(-1)
    edgeness = np.where(small < 0.02 * large, large, 0.0)
    # A flat wall that is black or burnt out would be a poor example: it cannot even be noisy.
    level = gray[inside]
    flatness = np.where((level > 60) & (level < 200), -large, -np.inf)
    return {
        "flat": _best(flatness, gray, range(1)),
        "edge": _best(edgeness, gray, range(5, 9)),
        "corner": _best(small, gray, range(9, 13)),
    }


def look_around(
    gray: NDArray[np.uint8], points: Mapping[str, tuple[int, int]], *, reach: int = 6
) -> Figure:
    """Show patches and how much each differs from itself when moved a little.

    Parameters
    ----------
    gray : uint8, shape (h, w)
        Grey picture.
    points : mapping of str to (x, y)
        Named pixels, at least 20 pixels from the border.
    reach : int
        Largest move to each side, in pixels.

    Returns
    -------
    Figure
        A column per point: the patch above, below it the sum of squared differences for
        every move; dark means "looks the same from there".
    """
    half, values = 8, gray.astype(np.float64)
    figure = Figure(figsize=(2.3 * len(points), 4.7), layout="constrained")
    axes = figure.subplots(2, len(points), squeeze=False)
    maps = {
        name: np.array(
            [
                [_difference(values, x, y, dx, dy, half) for dx in range(-reach, reach + 1)]
                for dy in range(-reach, reach + 1)
            ]
        )
        for name, (x, y) in points.items()
    }
    highest = max(float(m.max()) for m in maps.values())
    for column, (name, (x, y)) in enumerate(points.items()):
        patch = gray[y - half : y + half + 1, x - half : x + half + 1]
        axes[0, column].imshow(patch, cmap="gray", vmin=0, vmax=255)
        axes[0, column].set_title(name)
        axes[1, column].imshow(
            np.sqrt(maps[name]), cmap="magma", vmin=0, vmax=np.sqrt(highest),
            extent=(-reach - 0.5, reach + 0.5, reach + 0.5, -reach - 0.5),
        )  # fmt: skip
        axes[1, column].set_xlabel("moved right by (px)")
        _bare(axes[0, column])
    axes[1, 0].set_ylabel("moved down by (px)")
    return figure


def ring(gray: NDArray[np.uint8], x: int, y: int) -> Figure:
    """Show the ring of FAST round a pixel: the 16 pixels numbered, the centre marked p.

    Parameters
    ----------
    gray : uint8, shape (h, w)
        Grey picture.
    x, y : int
        The centre, at least 4 pixels from the border.

    Returns
    -------
    Figure
        The 9 by 9 pixels round the centre.
    """
    figure = Figure(figsize=(4.2, 4.2), layout="constrained")
    axis = figure.subplots()
    axis.imshow(
        gray[y - 4 : y + 5, x - 4 : x + 5], cmap="gray", vmin=0, vmax=255,
        extent=(-4.5, 4.5, 4.5, -4.5),
    )  # fmt: skip
    axis.add_patch(Circle((0, 0), 3, fill=False, color=CENTRE, lw=1, ls=":"))
    for number, (dx, dy) in enumerate(CIRCLE, start=1):
        compass = number in {1, 5, 9, 13}
        axis.add_patch(Circle((dx, dy), 0.42, color=CENTRE if compass else "#34495e"))
        axis.text(dx, dy, str(number), ha="center", va="center", color="white", fontsize=11)
    axis.text(0, 0, "p", ha="center", va="center", color=CENTRE, fontsize=18, weight="bold")
    _bare(axis)
    return figure


def unrolled(
    gray: NDArray[np.uint8], points: Mapping[str, tuple[int, int]], threshold: int
) -> Figure:
    """Show the 16 ring pixels of several points as bars, coloured by the segment test.

    Parameters
    ----------
    gray : uint8, shape (h, w)
        Grey picture.
    points : mapping of str to (x, y)
        Named pixels, at least 3 pixels from the border.
    threshold : int
        The threshold t, in grey levels.

    Returns
    -------
    Figure
        One chart per point: bars above the band I_p ± t are brighter, below it darker.
    """
    figure = Figure(figsize=(3.0 * len(points), 2.9), layout="constrained")
    axes = figure.subplots(1, len(points), sharey=True, squeeze=False)[0]
    for axis, (name, (x, y)) in zip(axes, points.items(), strict=True):
        centre = int(gray[y, x])
        levels = [int(gray[y + dy, x + dx]) for dx, dy in CIRCLE]
        colours = [
            BRIGHTER if v > centre + threshold else DARKER if v < centre - threshold else SIMILAR
            for v in levels
        ]
        axis.bar(range(1, 17), levels, color=colours, edgecolor="#555555", linewidth=0.5)
        axis.axhspan(centre - threshold, centre + threshold, color=CENTRE, alpha=0.15)
        axis.axhline(centre, color=CENTRE, lw=1.5)
        axis.set(title=name, xlabel="ring pixel", xticks=(1, 5, 9, 13), ylim=(0, 255))
    axes[0].set_ylabel("grey level")
    return figure


def sampling(
    pairs: Mapping[str, Iterable[tuple[float, float, float, float]]], *, patch_size: int = 31
) -> Figure:
    """Draw BRIEF's test pairs as line segments, one square patch per geometry.

    Parameters
    ----------
    pairs : mapping of str to sequence of (x1, y1, x2, y2)
        For each named geometry the pairs, in pixels from the patch centre.
    patch_size : int
        Side of the patch in pixels.

    Returns
    -------
    Figure
        One square per geometry, in the mapping's order.
    """
    figure = Figure(figsize=(2.3 * len(pairs), 2.6), layout="constrained")
    half = patch_size / 2
    for axis, (name, tests) in zip(
        figure.subplots(1, len(pairs), squeeze=False)[0], pairs.items(), strict=True
    ):
        for x1, y1, x2, y2 in tests:
            axis.plot((x1, x2), (y1, y2), color=DARKER, lw=0.6, alpha=0.7)
        axis.set(title=name, xlim=(-half, half), ylim=(half, -half), aspect="equal")
        _bare(axis)
    return figure


def _best(
    measure: NDArray[np.floating], gray: NDArray[np.uint8], arcs: range, threshold: int = 20
) -> tuple[int, int]:
    """Pixel (x, y) where a measure of the picture's inside is largest and FAST agrees.

    FAST agrees when its ring holds pixels of one side only, in an arc of one of these lengths. If
    it agrees nowhere, the measure alone decides.
    """
    order = np.argsort(measure, axis=None)[::-1][:4000]
    columns = measure.shape[1]
    places = [(int(i % columns) + MARGIN, int(i // columns) + MARGIN) for i in order]
    for x, y in places:
        states = signs(gray, x, y, threshold)
        length, _, _ = longest_arc(states)
        if length in arcs and length == sum(state != 0 for state in states):
            return x, y
    return places[0]


def _difference(values: NDArray[np.float64], x: int, y: int, dx: int, dy: int, half: int) -> float:
    """Mean squared difference between the patch at (x, y) and the patch (dx, dy) away."""
    here = values[y - half : y + half + 1, x - half : x + half + 1]
    there = values[y + dy - half : y + dy + half + 1, x + dx - half : x + dx + half + 1]
    return float(np.mean((here - there) ** 2))


def _bare(axis: Axes) -> None:
    """Take the ticks off a picture: its pixels are not a scale."""
    axis.set_xticks([])
    axis.set_yticks([])
