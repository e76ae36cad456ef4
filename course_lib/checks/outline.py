"""Compare an outline with the right one, and recognise the usual mistakes by their geometry."""

from __future__ import annotations

from itertools import permutations
from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib.checks.work import WrongError
from course_lib.homography import Matrix, project, template_corners

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    Points = NDArray[np.float64]

ORDER = "[[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]"
# How near an outline must come to what a mistake predicts, as a share of that one's diagonal.
_NAMED = 0.1


def as_corners(found: object, name: str) -> Points:
    """
    Return a function's result as four corners.

    Raises
    ------
    WrongError
        It is something else.
    """
    if not isinstance(found, np.ndarray):
        kind = type(found).__name__
        raise WrongError(f"{name} should return an array of shape (4, 2) or None, not {kind}.")
    if found.shape in {(4, 1, 2), (1, 4, 2)}:
        raise WrongError(
            f"{name} returns OpenCV's shape {found.shape}. Add .reshape(4, 2) to the result."
        )
    if found.shape == (3, 3):
        raise WrongError(
            f"{name} returns the homography. Send the template's corners through it with "
            "cv2.perspectiveTransform."
        )
    if found.shape != (4, 2) or found.dtype.kind not in "iuf":
        raise WrongError(f"{name} should return an array of shape (4, 2), not {found.shape}.")
    corners = np.asarray(found, np.float64)
    if not np.isfinite(corners).all():
        raise WrongError(f"{name} returns corners that are NaN or infinite. Return None then.")
    return corners


def must_match(
    found: object,
    right: Points,
    template: tuple[int, int],
    tolerance: float,
    name: str,
    where: str,
) -> None:
    """
    Ask whether an outline is the right one.

    Parameters
    ----------
    found : object
        What the student's function returned.
    right : ndarray of float64, shape (4, 2)
    template : (width, height)
    tolerance : float
        How far off, in pixels, the corners may be on average.
    name, where : str
        The function, and the picture: "on the shelf".

    Raises
    ------
    WrongError
    """
    if found is None:
        raise WrongError(
            f"{name} returns None, but the thing is there ({where}). Print the number of inliers: "
            "are there too few, or is your test of the outline too strict?"
        )
    corners = as_corners(found, name)
    if _off(corners, right) <= tolerance:
        return
    if _off(_undone(corners, template), right) <= 2 * _NAMED * _size(right):
        raise WrongError(
            "The homography goes the wrong way: findHomography takes the template's points first, "
            f"then the scene's ({where})"
        )
    for guess, help_text in _mistakes(right, template):
        if np.isfinite(guess).all() and _off(corners, guess) <= _NAMED * _size(guess):
            raise WrongError(f"{help_text} ({where})")
    if not cv2.isContourConvex(np.asarray(corners, np.float32)):
        raise WrongError(
            f"The outline crosses itself ({where}): the matches do not agree. Are they sorted and "
            "cross-checked? Does queryIdx count the template's keypoints? If they never agree, "
            "return None."
        )
    if _off(corners, right) <= 0.3 * _size(right):
        raise WrongError(
            f"The outline is roughly there, but not on it ({where}). Use the best hundred matches, "
            "and RANSAC with a threshold of 5 pixels."
        )
    raise WrongError(
        f"The outline is far from where it should be ({where}). Draw the matches: are they sorted? "
        "Is queryIdx used for the template and trainIdx for the scene? Is cv2.RANSAC given to "
        "findHomography?"
    )


def _mistakes(right: Points, template: tuple[int, int]) -> Iterator[tuple[Points, str]]:
    corners = template_corners(template).astype(np.float64)
    H = _homography(corners, right)
    yield (
        project(H, template_corners(template[::-1]).astype(np.float64)),
        "Width and height are swapped in the corners: h, w = template.shape[:2]",
    )
    yield right[:, ::-1], "x and y are swapped: a corner is (x, y)"
    yield corners, "These are the template's own corners: send them through the homography"
    for order in permutations(range(4)):
        yield (
            right[list(order)],
            f"The corners are at the right places, in the wrong order: it is {ORDER}",
        )


def _undone(corners: Points, template: tuple[int, int]) -> Points:
    """Return where the template would be if the outline were drawn by the inverse homography."""
    own = template_corners(template).astype(np.float64)
    try:
        return project(_homography(corners, own), own)
    except (np.linalg.LinAlgError, cv2.error):
        return np.full((4, 2), np.inf)


def _homography(source: Points, target: Points) -> Matrix:
    found = cv2.getPerspectiveTransform(source.astype(np.float32), target.astype(np.float32))
    return np.asarray(found, np.float64)


def _off(a: Points, b: Points) -> float:
    return float(np.linalg.norm(a - b, axis=1).mean())


def _size(points: Points) -> float:
    return float(np.linalg.norm(np.ptp(points, axis=0)))
