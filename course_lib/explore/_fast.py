"""The FAST viewer: every corner with its score, so that a threshold is only a filter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import ipywidgets
import numpy as np
from traitlets import Bool, Bytes, Float, Int

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
    from numpy.typing import NDArray

MARK_BGR = (255, 229, 0)


class FastCanvas(Canvas):
    """Corners over a picture; `all_*` without suppression, `kept_*` with it, best score first."""

    _esm = module("fast")

    threshold = Int().tag(sync=True)
    nonmax = Bool().tag(sync=True)
    scale = Float().tag(sync=True)
    all_points = Bytes().tag(sync=True)
    all_scores = Bytes().tag(sync=True)
    kept_points = Bytes().tag(sync=True)
    kept_scores = Bytes().tag(sync=True)


def fast(
    image: NDArray[np.uint8],
    *,
    nonmax: bool | None = None,
    threshold: int = 20,
    max_threshold: int | None = None,
    alt: str | None = None,
) -> Viewer:
    """Show the FAST corners of a picture, with a slider for the threshold.

    A corner's score is the highest threshold at which it is still a corner, so the corners at a
    threshold are those that score at least as much, with suppression and without: the browser
    filters, the kernel is never asked again.

    Parameters
    ----------
    image
        Picture, BGR or grey uint8 of shape (height, width[, 3]).
    nonmax
        Non-maximum suppression: True or False fixes it, None shows a switch (on at first).
    threshold
        Threshold shown first, in grey levels.
    max_threshold
        Right end of the slider; by default the lowest threshold that leaves no corner.
    alt
        Text alternative of the viewer.

    Returns
    -------
    Viewer
        Slider, switch and canvas.

    Raises
    ------
    TypeError, ValueError
        When `image` is no picture, or a threshold is outside 1 … 255.

    References
    ----------
    Rosten and Drummond, "Machine learning for high-speed corner detection", ECCV 2006.
    """
    picture = colour_picture(image)
    scores = score_map(np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.uint8))
    kept = np.where(is_maximum(scores), scores, 0)
    if max_threshold is None:
        max_threshold = int(np.clip(scores.max() + 1, threshold, 255))
    for name, value in (("threshold", threshold), ("max_threshold", max_threshold)):
        if not 1 <= value <= 255:
            raise ValueError(f"{name} must be a grey level from 1 to 255, not {value}")
    if threshold > max_threshold:
        raise ValueError(f"threshold {threshold} is above max_threshold {max_threshold}")

    suppress = nonmax is None or nonmax
    shown = kept if suppress else scores
    height, width = picture.shape[:2]
    scale = _display_scale(width)
    count = int((shown >= threshold).sum())
    alt = alt or (
        f"FAST corners over a picture, with a slider for the threshold: {count} corners at "
        f"threshold {threshold}, {'with' if suppress else 'without'} non-maximum suppression."
    )
    canvas = FastCanvas(
        picture=jpeg(picture),
        width=round(width * scale),
        height=round(height * scale),
        scale=scale,
        threshold=threshold,
        nonmax=suppress,
        alt=alt,
        **ranked("all", scores),
        **ranked("kept", kept),
    )
    control = slider("threshold", threshold, 1, max_threshold)
    link(control, canvas, "threshold")
    controls: list[ipywidgets.Widget] = [control]
    if nonmax is None:
        switch = ipywidgets.Checkbox(
            value=True, description="non-maximum suppression", indent=False
        )
        link(switch, canvas, "nonmax")
        controls.append(switch)
    still = _draw(picture, shown, threshold)
    label = f"FAST threshold {threshold}: {count} corners. Run the notebook to move the slider."
    return Viewer([*controls, canvas], still=caption(still, label), alt=alt)


def ranked(name: str, scores: NDArray[np.uint8]) -> dict[str, bytes]:
    """Pack the corners for the browser, best first: the first k are those of some threshold."""
    ys, xs = np.nonzero(scores)
    values = scores[ys, xs]
    order = np.argsort(values, kind="stable")[::-1]
    points = np.column_stack([xs, ys])[order].astype("<u2")
    return {f"{name}_points": points.tobytes(), f"{name}_scores": values[order].tobytes()}


def _display_scale(width: int) -> float:
    """Enlarge small pictures by whole steps, shrink those that are wider than a notebook cell."""
    return 640 / width if width > 640 else max(1, 400 // width)


def _draw(
    picture: NDArray[np.uint8], scores: NDArray[np.uint8], threshold: int
) -> NDArray[np.uint8]:
    still = picture.copy()
    for y, x in np.argwhere(scores >= threshold):
        cv2.circle(still, (int(x), int(y)), 3, MARK_BGR, 1, cv2.LINE_AA)
    return still
