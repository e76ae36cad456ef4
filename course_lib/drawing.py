"""Draw keypoints, matches and outlines upon pictures; every function returns a new picture."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import cv2
import numpy as np

from course_lib._validate import Image, as_bgr, as_corners
from course_lib.detection import Detection
from course_lib.display import encode_png, plot, show

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray


__all__ = [
    "CYAN",
    "GREEN",
    "GREY",
    "ORANGE",
    "draw_keypoints",
    "draw_matches",
    "draw_outline",
    "encode_png",
    "plot",
    "show",
]

Colour: TypeAlias = tuple[int, int, int]

# BGR. Told apart by readers with any kind of colour vision (after Okabe and Ito's palette).
ORANGE: Colour = (0, 159, 230)
GREEN: Colour = (115, 158, 0)
CYAN: Colour = (255, 220, 60)
GREY: Colour = (150, 150, 150)

# OpenCV draws at fractions of a pixel when coordinates are given in units of 1/16.
SHIFT = 4
# Far enough for any picture, near enough that fixed-point coordinates cannot overflow.
FAR = 1e6


def draw_keypoints(
    image: Image,
    keypoints: Sequence[cv2.KeyPoint],
    *,
    color: Colour = ORANGE,
    rich: bool = True,
) -> Image:
    """
    Draw keypoints as circles of their size with a line along their angle.

    Parameters
    ----------
    image : ndarray
        BGR uint8, or what :func:`course_lib._validate.as_image` accepts.
    keypoints : sequence of cv2.KeyPoint
    color : tuple of int
        BGR.
    rich : bool
        False draws equal small circles without angles.

    Returns
    -------
    ndarray of uint8, shape (H, W, 3)
        BGR.
    """
    canvas = as_bgr(image, "image")
    # Dark rims keep the marks visible on any background; all rims lie below all marks.
    for thickness, ink in ((3, (0, 0, 0)), (1, color)):
        for keypoint in keypoints:
            radius = max(keypoint.size / 2, 2.0) if rich else 3.0
            centre = np.array(keypoint.pt)
            around = _fixed(centre), round(radius * 2**SHIFT)
            cv2.circle(canvas, *around, ink, thickness, cv2.LINE_AA, SHIFT)
            if rich and keypoint.angle >= 0:
                turn = np.deg2rad(keypoint.angle)
                end = centre + radius * np.array([np.cos(turn), np.sin(turn)])
                cv2.line(canvas, _fixed(centre), _fixed(end), ink, thickness, cv2.LINE_AA, SHIFT)
    return canvas


def draw_matches(
    template: Image,
    template_keypoints: Sequence[cv2.KeyPoint],
    scene: Image,
    scene_keypoints: Sequence[cv2.KeyPoint],
    matches: Sequence[cv2.DMatch],
    *,
    inliers: ArrayLike | None = None,
    outliers: bool = True,
) -> Image:
    """
    Draw two pictures side by side with a line for each match.

    Parameters
    ----------
    template, scene : ndarray
        BGR uint8, or what :func:`course_lib._validate.as_image` accepts.
    template_keypoints, scene_keypoints : sequence of cv2.KeyPoint
    matches : sequence of cv2.DMatch
        ``queryIdx`` counts template keypoints, ``trainIdx`` scene keypoints.
    inliers : array_like of bool, shape (len(matches),), or None
        Inliers are drawn in orange above the outliers, which are thin and grey. None draws all
        matches alike.
    outliers : bool
        False leaves the outliers out.

    Returns
    -------
    ndarray of uint8, shape (max of heights, sum of widths, 3)
        BGR.

    Raises
    ------
    ValueError
        Inliers are not one per match, or a match names a keypoint that does not exist (query and
        train swapped).
    """
    left, right = as_bgr(template, "template"), as_bgr(scene, "scene")
    good = np.ones(len(matches), bool) if inliers is None else np.asarray(inliers, bool).ravel()
    if len(good) != len(matches):
        raise ValueError(f"inliers has {len(good)} entries for {len(matches)} matches")
    for match in matches:
        if match.queryIdx >= len(template_keypoints) or match.trainIdx >= len(scene_keypoints):
            raise ValueError(
                f"matches name template keypoint {match.queryIdx} of {len(template_keypoints)} and "
                f"scene keypoint {match.trainIdx} of {len(scene_keypoints)}: "
                "are template and scene swapped?"
            )
    height = max(left.shape[0], right.shape[0])
    canvas = np.full((height, left.shape[1] + right.shape[1], 3), 255, np.uint8)
    canvas[: left.shape[0], : left.shape[1]] = left
    canvas[: right.shape[0], left.shape[1] :] = right
    offset = np.array([left.shape[1], 0])
    # Outliers first, so that they never cover an inlier.
    for wanted in (False, True):
        if not wanted and not outliers:
            continue
        ink = ORANGE if wanted else GREY
        for match in (m for m, ok in zip(matches, good, strict=True) if bool(ok) is wanted):
            start = np.array(template_keypoints[match.queryIdx].pt)
            end = np.array(scene_keypoints[match.trainIdx].pt) + offset
            cv2.line(canvas, _fixed(start), _fixed(end), ink, 1, cv2.LINE_AA, SHIFT)
            for point in (start, end):
                cv2.circle(canvas, _fixed(point), 3 << SHIFT, ink, 1, cv2.LINE_AA, SHIFT)
    return canvas


def draw_outline(
    scene: Image,
    outline: Detection | ArrayLike | None,
    *,
    color: Colour = GREEN,
    thickness: int = 3,
    label: str | None = None,
) -> Image:
    """
    Draw where a template was found; its top edge is marked, so that a rotation can be seen.

    Parameters
    ----------
    scene : ndarray
        BGR uint8, or what :func:`course_lib._validate.as_image` accepts.
    outline : Detection, array_like of shape (4, 2) or (4, 1, 2), or None
        Corners in the order of :class:`course_lib.localize.Detection`. Nothing is drawn for None
        or for a detection that found nothing.
    color : tuple of int
        BGR.
    thickness : int
        Of the line, in pixels.
    label : str or None
        A word beside the top-left corner (ASCII).

    Returns
    -------
    ndarray of uint8, shape (H, W, 3)
        BGR.
    """
    canvas = as_bgr(scene, "scene")
    found = outline.corners if isinstance(outline, Detection) else outline
    if found is None:
        return canvas
    corners = as_corners(found, "outline")
    closed = _fixed_array(corners)
    for width, ink in ((thickness + 2, (255, 255, 255)), (thickness, color)):
        cv2.polylines(canvas, [closed], True, ink, width, cv2.LINE_AA, SHIFT)  # noqa: FBT003
    cv2.line(canvas, _fixed(corners[3]), _fixed(corners[0]), ORANGE, thickness, cv2.LINE_AA, SHIFT)
    if label:
        place = (round(float(corners[0, 0])) + 6, round(float(corners[0, 1])) - 8)
        for width, ink in ((4, (255, 255, 255)), (1, (0, 0, 0))):
            cv2.putText(
                canvas, label, place, cv2.FONT_HERSHEY_SIMPLEX, 0.6, ink, width, cv2.LINE_AA
            )
    return canvas


def _fixed_array(points: NDArray[np.float64]) -> NDArray[np.int32]:
    return np.asarray(np.rint(np.clip(points, -FAR, FAR) * 2**SHIFT), np.int32)


def _fixed(point: NDArray[np.float64]) -> tuple[int, int]:
    x, y = _fixed_array(point)
    return int(x), int(y)
