"""Outlines as data: four corners, how far off they are, how much they overlap."""

from __future__ import annotations

import math
from itertools import permutations
from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib.homography import template_corners

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Nothing that a camera can see lies further away; beyond it, squares and areas may overflow.
FARTHEST = 1e6


def as_outline(found: object) -> NDArray[np.float64] | None:
    """
    Return four corners as numbers, or None if they are not that.

    Parameters
    ----------
    found : object
        Anything that a submission may return.

    Returns
    -------
    ndarray of float64, shape (4, 2), or None
        None for another shape, for what is not real numbers, for NaN and infinity.
    """
    if found is None or isinstance(found, str | bytes):
        return None
    try:
        points = np.asarray(found)
    except (TypeError, ValueError):  # ragged lists
        return None
    if points.shape != (4, 2) or points.dtype.kind not in "iuf":
        return None
    numbers = points.astype(np.float64)
    return numbers if np.isfinite(numbers).all() else None


def means_nothing(found: object) -> bool:
    """
    Tell whether a result says "not there", though not by None as was asked.

    Parameters
    ----------
    found : object
        Anything that a submission may return, but None.

    Returns
    -------
    bool

    Examples
    --------
    >>> [means_nothing(each) for each in ([], False, "not found", [[0, 0]] * 4, [[0, 0], [9, 9]])]
    [True, True, True, True, False]
    """
    if isinstance(found, bool | str):
        return True
    try:
        numbers = np.asarray(found)
    except (TypeError, ValueError):  # ragged lists
        return False
    if numbers.dtype.kind not in "iuf":
        return numbers.size == 0
    # One number again and again, such as 0, is no outline; NaN comes of a homography gone wrong.
    return numbers.size == 0 or not np.ptp(numbers.astype(np.float64))


def corner_error(found: object, true: ArrayLike) -> float:
    """
    Return how far four corners are off.

    Parameters
    ----------
    found : object
        Anything that a submission may return.
    true : array_like, shape (4, 2)

    Returns
    -------
    float
        The root of the mean squared distance of the four corners, in pixels. Infinite for
        anything that is not four finite points.

    Examples
    --------
    >>> square = [[0, 0], [0, 9], [9, 9], [9, 0]]
    >>> corner_error(np.add(square, [3, 4]), square)
    5.0
    >>> corner_error(None, square)
    inf
    """
    points = as_outline(found)
    if points is None or np.abs(points).max() > FARTHEST:
        return math.inf
    offsets = points - np.asarray(true, np.float64).reshape(4, 2)
    return float(np.sqrt((offsets**2).sum(axis=1).mean()))


def reformed(found: object, true: ArrayLike) -> NDArray[np.float64] | None:
    """
    Return the same four corners in the asked shape and order, or None if they are not that.

    Parameters
    ----------
    found : object
        Anything that a submission may return, such as an array of shape (4, 1, 2).
    true : array_like, shape (4, 2)
        Of all orders, the one that comes nearest is taken.

    Returns
    -------
    ndarray of float64, shape (4, 2), or None

    Examples
    --------
    >>> reformed([[0, 0], [9, 0], [9, 9], [0, 9]], [[0, 0], [0, 8], [8, 8], [8, 0]])[1]
    array([0., 9.])
    """
    points = as_outline(_in_shape(found))
    if points is None or np.abs(points).max() > FARTHEST:
        return None
    return nearest_order(points, np.asarray(true, np.float64))


def _in_shape(found: object) -> object:
    """Return (4, 2) for four corners in another shape; anything else as it is."""
    if isinstance(found, tuple | list):  # the corners, and the inliers with them
        return next((each for each in found if as_outline(each) is not None), found)
    # Only what has a shape of its own is reshaped: a nested list may hold anything.
    if not isinstance(found, np.ndarray):
        return found
    if found.shape in {(4, 1, 2), (1, 4, 2), (8,)}:
        return found.reshape(4, 2)
    if found.shape == (2, 4):
        return found.T
    # The first once more, to close the outline.
    if found.shape in {(5, 2), (5, 1, 2)} and np.array_equal(found[0], found[4]):
        return found[:4].reshape(4, 2)
    return found


def nearest_order(corners: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return corners in the order in which they come nearest to some points, both (4, 2)."""
    orders = [corners[list(order)] for order in permutations(range(4))]
    return min(orders, key=lambda order: float(((points - order) ** 2).sum()))


def expected_outline(
    crop: ArrayLike, silhouette_there: ArrayLike, silhouette_here: ArrayLike
) -> NDArray[np.float64]:
    """
    Return where the outline of a student's own crop of the well belongs in another frame.

    The well is no plane, so no homography is the true one. What can be asked is that the outline
    lies about the well as the crop's rectangle did: the box around the silhouette in the crop's
    frame is sent to the box around the silhouette here, and the rectangle goes along. A crop with
    a wide margin, or of the stone ring alone, is thus judged by itself.

    Parameters
    ----------
    crop : array_like (x, y, width, height)
        The crop's rectangle in the frame it was cut from, pixels.
    silhouette_there, silhouette_here : array_like, shape (N, 2)
        The well's whole silhouette in that frame and in this.

    Returns
    -------
    ndarray of float64, shape (4, 2)
    """
    x, y, width, height = np.asarray(crop, np.float64)
    corners = template_corners((int(width), int(height))).astype(np.float64) + (x, y)
    low_there, low_here = (np.min(each, axis=0) for each in (silhouette_there, silhouette_here))
    size_there, size_here = (np.ptp(each, axis=0) for each in (silhouette_there, silhouette_here))
    return np.asarray(low_here + (corners - low_there) * size_here / size_there, np.float64)


def outline_overlap(found: object, expected: ArrayLike) -> float:
    """
    Return how much two outlines overlap: intersection over union.

    Parameters
    ----------
    found : object
        What the submission returned.
    expected : array_like, shape (4, 2)
        Convex; see :func:`expected_outline`.

    Returns
    -------
    float
        From 0 to 1. 0 for what is not four points, for a folded or mirrored outline, and for
        corners in another order than ``expected``'s (turned by more than 45°).
    """
    points = as_outline(found)
    if points is None or np.abs(points).max() > FARTHEST:
        return 0.0
    right = np.asarray(expected, np.float64).reshape(4, 2)
    if not is_upright_like(points, right):
        return 0.0
    areas = [abs(_signed_area(each)) for each in (points, right)]
    shared, _ = cv2.intersectConvexConvex(points.astype(np.float32), right.astype(np.float32))
    union = sum(areas) - shared
    return float(min(max(shared / union, 0.0), 1.0)) if union > 0 else 0.0


def is_upright_like(points: NDArray[np.float64], right: NDArray[np.float64]) -> bool:
    """Tell whether an outline is convex, and runs and starts as another: turned by under 45°."""
    if not is_convex(points) or _signed_area(points) * _signed_area(right) <= 0:
        return False
    a, b = points - points.mean(axis=0), right - right.mean(axis=0)
    scores = [float((np.roll(a, turn, axis=0) * b).sum()) for turn in range(4)]
    return int(np.argmax(scores)) == 0


def is_convex(points: NDArray[np.float64]) -> bool:
    """Tell whether four corners in order go around a convex shape of some size."""
    sides = np.roll(points, -1, axis=0) - points
    following = np.roll(sides, -1, axis=0)
    turns = sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0]
    return bool((turns > 1e-6).all() or (turns < -1e-6).all())


def _signed_area(points: NDArray[np.float64]) -> float:
    x, y = points.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)
