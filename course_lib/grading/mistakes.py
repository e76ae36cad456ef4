"""Which usual mistake a wrong outline looks like, told from its geometry alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from course_lib.grading.mistake_texts import MESSAGES
from course_lib.grading.outlines import (
    FARTHEST,
    as_outline,
    corner_error,
    is_convex,
    means_nothing,
    nearest_order,
)
from course_lib.homography import project, template_corners

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import ArrayLike, NDArray

    Points = NDArray[np.float64]

# A result this near, as a share of the outline's diagonal, is right or nearly so.
RIGHT = 0.04
NEAR = 0.15
# A mistake is named when what it predicts is this near, and much nearer than the truth is.
NAMED = 0.07
# Near the truth, an honest but rough result could look like a small shift: be surer there.
NAMED_NEAR = 0.012
MUCH_NEARER = 0.4
LEAST_SCALE = 0.05
MOST_UINT8 = 255

# Who makes one of these has found the object all the same.
HAS_FOUND = frozenset(
    ("(4, 1, 2)", "transposed", "flat", "homography", "box", "five", "inverse", "order", "xy", "wh")
    + ("one point", "with more", "within", "wrapped")
    + ("scene outline", "template size", "upright", "resized", "resized swapped", "beside")
    + ("shifted", "flipped", "depth", "unit", "near")
)

SHAPES = {(4, 1, 2): "(4, 1, 2)", (1, 4, 2): "(4, 1, 2)", (2, 4): "transposed", (8,): "flat",
          (3, 3): "homography", (4,): "box", (2,): "one point", (1, 2): "one point",
          (1, 1, 2): "one point", (3, 2): "three", (3, 1, 2): "three", (5, 2): "five",
          (5, 1, 2): "five"}  # fmt: skip


def diagnose(
    found: object,
    true: ArrayLike | None,
    template_shape: Sequence[int],
    scene_shape: Sequence[int],
    *,
    thing: str = "mug",
) -> str | None:
    """
    Say in the student's words which usual mistake a result looks like.

    Parameters
    ----------
    found : object
        What the submission returned; anything.
    true : array_like, shape (4, 2), or None
        The right corners; None where the object is absent.
    template_shape, scene_shape : (height, width, ...)
    thing : str
        What is looked for.

    Returns
    -------
    str or None
        None for a result that is right, to 4 % of the outline's size. Never a number of the
        hidden scene.
    """
    name = recognise(found, true, template_shape, scene_shape)
    return None if name is None else MESSAGES[name].format(thing=thing)


def recognise(
    found: object,
    true: ArrayLike | None,
    template_shape: Sequence[int],
    scene_shape: Sequence[int],
) -> str | None:
    """Return the mistake's key in ``MESSAGES``, None for a right result; see :func:`diagnose`."""
    if true is None:
        if found is None:
            return None
        return "nothing" if means_nothing(found) else "absent"
    if found is None:
        return "none"
    points = as_outline(found)
    if points is None:
        return _wrong_shape(found)
    right = np.asarray(true, np.float64).reshape(4, 2)
    error = corner_error(points, right)
    size = _diagonal(right)
    if error <= RIGHT * size:
        return None
    if np.abs(points).max() > FARTHEST:
        return "far"
    guesses = _guesses(points, right, _size(template_shape), _size(scene_shape))
    misfit, name = min(_explained(points, right, guesses), default=(np.inf, ""))
    if error <= NEAR * size and misfit >= NAMED_NEAR:
        return "near"
    return name or _vague(points, right)


def _explained(
    points: Points, right: Points, guesses: Iterable[tuple[str, Points, int]]
) -> Iterator[tuple[float, str]]:
    """Yield the mistakes that explain the points, each with how far off it is."""
    size, error = _diagonal(right), corner_error(points, right)
    for name, guess, handicap in guesses:
        # A guess that is the truth again, such as the box around an upright mug, explains nothing.
        if not np.isfinite(guess).all() or corner_error(guess, right) <= RIGHT * size:
            continue
        misfit = corner_error(points, guess) / max(_diagonal(guess), 1e-9)
        # What was fitted to the points explains less than what is fixed.
        misfit = misfit * (1 + handicap) + 0.005 * handicap
        if misfit < NAMED and misfit < MUCH_NEARER * error / size:
            yield misfit, name


def _wrong_shape(found: object) -> str:
    if isinstance(found, tuple | list) and any(as_outline(each) is not None for each in found):
        return "with more"
    try:
        points: NDArray[Any] = np.asarray(found)
    except (TypeError, ValueError):
        return "kind"
    if points.dtype.kind not in "iuf":
        return "kind"
    if points.shape == (4, 2):
        return "nan"
    if points.shape in SHAPES:
        return SHAPES[points.shape]
    many = points.ndim in (2, 3) and points.shape[-1] == 2 and points.size > 10
    return "matches" if many else "kind"


def _guesses(
    points: Points, right: Points, template: tuple[int, int], scene: tuple[int, int]
) -> Iterator[tuple[str, Points, int]]:
    """
    Yield a mistake's key, what it would have returned, and a handicap.

    The handicap is 1 for what was fitted and what is less likely. Sizes are (width, height).
    """
    corners = template_corners(template).astype(np.float64)
    frame = template_corners(scene).astype(np.float64)
    H = _homography(corners, right)
    inverse = _homography(right, corners)
    low, high = right.min(axis=0), right.max(axis=0)
    box = np.array([low, [low[0], high[1]], high, [high[0], low[1]]])
    yield "inverse", project(inverse, corners), 0
    yield "inverse", project(inverse, frame), 0
    yield "xy", right[:, ::-1], 0
    yield "wh", project(H, template_corners(template[::-1]).astype(np.float64)), 0
    if scene != template[::-1]:
        yield "scene outline", project(H, frame), 0
    yield "order", nearest_order(right, points), 0
    yield "scene", nearest_order(frame, points), 0
    yield "template", nearest_order(corners, points), 0
    # It is its corners' order that is wrong first, where an object hardly leans.
    if corner_error(nearest_order(box, right), right) > RIGHT * _diagonal(right):
        yield "upright", nearest_order(box, points), 1
    yield "unit", right / scene, 0
    if points.min() >= 0 and points.max() <= MOST_UINT8 < right.max():
        half = (MOST_UINT8 + 1) / 2
        yield "wrapped", points + (right - points + half) % (2 * half) - half, 1
    yield "depth", (corners @ H[:, :2].T + H[:, 2])[:, :2], 0
    yield "flipped", right * (-1, 1) + (scene[0] - 1, 0), 0
    yield "flipped", right * (1, -1) + (0, scene[1] - 1), 0
    yield "beside", right + (template[0], 0), 0
    yield "resized swapped", right * (scene[1] / scene[0], scene[0] / scene[1]), 0
    yield "shifted", right + (points - right).mean(axis=0), 1
    scale = (points * right).sum(axis=0) / (right**2).sum(axis=0)
    if scale.min() > LEAST_SCALE:
        yield "resized", right * scale, 1
    # In the template, an outline of another size starts at the same corner.
    there = project(inverse, points)
    scale = (there * corners).sum(axis=0) / (corners**2).sum(axis=0)
    if np.isfinite(there).all() and scale.min() > LEAST_SCALE:
        yield "template size", project(H, corners * scale), 1


def _homography(source: Points, target: Points) -> Points:
    found = cv2.getPerspectiveTransform(source.astype(np.float32), target.astype(np.float32))
    return np.asarray(found, np.float64)


def _vague(points: Points, right: Points) -> str:
    """Say at least what kind of outline it is."""
    if _diagonal(points) < RIGHT * _diagonal(right):
        return "collapsed"
    if not is_convex(points):
        return "folded"
    margin = NAMED_NEAR * _diagonal(right)
    inside = all(_signed_distance(right, point) >= -margin for point in points)
    return "within" if inside else "far"


def _signed_distance(outline: Points, point: Points) -> float:
    """Return how far inside an outline a point is; below zero outside."""
    x, y = point.tolist()
    return cv2.pointPolygonTest(outline.astype(np.float32), (x, y), measureDist=True)


def _diagonal(points: Points) -> float:
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _size(shape: Sequence[int]) -> tuple[int, int]:
    return int(shape[1]), int(shape[0])
