"""The match viewers: how many matches, and how strict, each with the outline that results."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import cv2
import numpy as np
from traitlets import Bytes, Float, Int, Unicode

from course_lib.explore._base import (
    Canvas,
    Viewer,
    colour_picture,
    jpeg,
    link,
    module,
    slider,
)
from course_lib.explore._estimate import Estimate, Pairer, Pairing, estimate
from course_lib.explore._still import caption

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

PAGE_WIDTH = 760
# BGR, as the browser draws them: told apart by their line style too.
INLIER_BGR, OUTLIER_BGR = (94, 197, 34), (68, 68, 239)
FAR = 30_000.0  # beyond any picture, within 16 bits and a canvas's reach


class MatchCanvas(Canvas):
    """Two pictures side by side; one estimate for every position of the slider."""

    _esm = module("matches")

    value = Float().tag(sync=True)
    first = Float().tag(sync=True)
    step = Float().tag(sync=True)
    matches = Int().tag(sync=True)
    lines = Bytes().tag(sync=True)
    shown = Bytes().tag(sync=True)
    inliers = Bytes().tag(sync=True)
    outlines = Bytes().tag(sync=True)
    texts = Unicode().tag(sync=True)


def matches(
    template: NDArray[np.uint8],
    scene: NDArray[np.uint8],
    *,
    match_count: int = 100,
    max_count: int | None = None,
    ransac_threshold: float = 5.0,
    alt: str | None = None,
) -> Viewer:
    """Show the best matches of two pictures and the outline they give, for every match count.

    Parameters
    ----------
    template, scene
        BGR or grey uint8 of shape (height, width[, 3]).
    match_count
        Number of best matches shown first.
    max_count
        Right end of the slider; by default all matches.
    ransac_threshold
        How far, in scene pixels, a match may be off and still be an inlier.
    alt
        Text alternative of the viewer.

    Returns
    -------
    Viewer
        Slider and canvas.

    Raises
    ------
    TypeError, ValueError
        When an input is no picture, or there are fewer than four matches to show.
    """
    template, scene, pairing = _paired(template, scene)
    last = len(pairing) if max_count is None else min(max_count, len(pairing))
    counts = list(range(4, last + 1))
    count = int(np.clip(match_count, 4, last))
    estimates = [estimate(pairing, n, ransac_threshold) for n in counts]
    texts = [f"{n} matches, {_verdict(e)}" for n, e in zip(counts, estimates, strict=True)]
    alt = alt or (
        "Template and scene side by side with their best matches and a slider for how many: "
        f"{texts[count - 4]}."
    )
    control = slider("matches used", count, 4, last)
    return _viewer(control, template, scene, pairing, counts, estimates, texts, alt)


def ransac(
    template: NDArray[np.uint8],
    scene: NDArray[np.uint8],
    *,
    match_count: int = 100,
    threshold: float = 5.0,
    max_threshold: float = 40.0,
    alt: str | None = None,
) -> Viewer:
    """Show which matches RANSAC takes for inliers, for every threshold.

    Parameters
    ----------
    template, scene
        BGR or grey uint8 of shape (height, width[, 3]).
    match_count
        Number of best matches used.
    threshold
        RANSAC threshold shown first, in scene pixels; the slider goes in half pixels.
    max_threshold
        Right end of the slider.
    alt
        Text alternative of the viewer.

    Returns
    -------
    Viewer
        Slider and canvas.

    Raises
    ------
    TypeError, ValueError
        When an input is no picture, or there are fewer than four matches to show.
    """
    template, scene, pairing = _paired(template, scene)
    thresholds = [k / 2 for k in range(1, round(2 * max_threshold) + 1)]
    count = min(match_count, len(pairing))
    estimates = [estimate(pairing, count, t) for t in thresholds]
    texts = [
        f"within {t:g} pixels: {_verdict(e)} (of {count} matches)"
        for t, e in zip(thresholds, estimates, strict=True)
    ]
    start = int(np.argmin([abs(t - threshold) for t in thresholds]))
    alt = alt or (
        "Template and scene side by side with their matches and a slider for the RANSAC "
        f"threshold: {texts[start]}."
    )
    control = slider("RANSAC threshold (pixels)", thresholds[start], 0.5, thresholds[-1], 0.5)
    counts = [count] * len(thresholds)
    return _viewer(control, template, scene, pairing, counts, estimates, texts, alt)


def _paired(
    template: NDArray[np.uint8], scene: NDArray[np.uint8]
) -> tuple[NDArray[np.uint8], NDArray[np.uint8], Pairing]:
    template, scene = colour_picture(template, "template"), colour_picture(scene, "scene")
    pairing = Pairer(template).pair(scene)
    if len(pairing) < 4:
        raise ValueError(
            f"template and scene have {len(pairing)} matches, and a homography needs 4: "
            "is one of them blank?"
        )
    return template, scene, pairing


def _verdict(result: Estimate) -> str:
    found = "found" if not result.fault else f"NOT found: {result.fault}"
    return f"{int(result.inliers.sum())} inliers, {found}"


def _viewer(
    control: object,
    template: NDArray[np.uint8],
    scene: NDArray[np.uint8],
    pairing: Pairing,
    counts: Sequence[int],
    estimates: Sequence[Estimate],
    texts: Sequence[str],
    alt: str,
) -> Viewer:
    picture = _side_by_side(template, scene)
    shift = template.shape[1]
    width = min(PAGE_WIDTH, picture.shape[1])
    n = len(pairing)
    inliers = np.zeros((len(estimates), n), np.uint8)
    outlines = np.full((len(estimates), 8), np.nan, np.float32)
    for row, result in enumerate(estimates):
        inliers[row, : len(result.inliers)] = result.inliers
        if result.corners is not None:
            # A negative first value could be a real place, so belief travels in `texts` only.
            outlines[row] = np.clip(result.corners + [shift, 0], -FAR, FAR).ravel()
    value, low, step = control.value, control.min, control.step  # type: ignore[attr-defined]
    canvas = MatchCanvas(
        picture=jpeg(picture),
        width=width,
        height=round(picture.shape[0] * width / picture.shape[1]),
        value=value,
        first=low,
        step=step,
        matches=n,
        lines=np.hstack(
            [pairing.template_points, pairing.scene_points + np.array([shift, 0], np.float32)]
        )
        .astype("<f4")
        .tobytes(),
        shown=np.array(counts, "<u2").tobytes(),
        inliers=inliers.tobytes(),
        outlines=outlines.astype("<f4").tobytes(),
        texts=json.dumps(
            {
                "all": list(texts),
                "width": picture.shape[1],
                "shift": shift,
                "heights": [template.shape[0], scene.shape[0]],
            }
        ),
        alt=alt,
    )
    link(control, canvas, "value")
    at = round((value - low) / step)
    still = _draw(picture, pairing, shift, counts[at], estimates[at])
    label = f"{texts[at]}. Run the notebook to move the slider."
    return Viewer([control, canvas], still=caption(still, label), alt=alt)


def _side_by_side(left: NDArray[np.uint8], right: NDArray[np.uint8]) -> NDArray[np.uint8]:
    height = max(left.shape[0], right.shape[0])
    sheet = np.full((height, left.shape[1] + right.shape[1], 3), 255, np.uint8)
    sheet[: left.shape[0], : left.shape[1]] = left
    sheet[: right.shape[0], left.shape[1] :] = right
    return sheet


def _draw(
    picture: NDArray[np.uint8], pairing: Pairing, shift: int, count: int, result: Estimate
) -> NDArray[np.uint8]:
    still = picture.copy()
    ends = np.rint(pairing.scene_points[:count] + [shift, 0]).astype(int).tolist()
    starts = np.rint(pairing.template_points[:count]).astype(int).tolist()
    for wanted, ink in ((False, OUTLIER_BGR), (True, INLIER_BGR)):
        for start, end, good in zip(starts, ends, result.inliers, strict=True):
            if bool(good) is wanted:
                cv2.line(still, start, end, ink, 1, cv2.LINE_AA)
    if result.corners is not None:
        outline = np.rint(np.clip(result.corners + [shift, 0], -FAR, FAR)).astype(np.int32)
        ink = OUTLIER_BGR if result.fault else INLIER_BGR
        cv2.polylines(still, [outline], True, ink, 3, cv2.LINE_AA)  # noqa: FBT003
    return still
