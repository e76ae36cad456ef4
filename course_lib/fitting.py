"""Fit views of the template to matches: groups, RANSAC, polish; the best possible one wins."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib._validate import as_count
from course_lib.homography import (
    estimate,
    method_code,
    project,
    reprojection_errors,
    template_corners,
)
from course_lib.outline import outline_fault
from course_lib.refine import Refined, keypoint_noise, refine, similarity
from course_lib.voting import groups

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from course_lib.pairs import Pairs

Size = tuple[int, int]

# Four pairs fit some homography exactly, so fewer than this proves nothing.
MIN_MATCHES = 4

# Corners less certain than this part of the outline's size are no answer.
MAX_RELATIVE_SIGMA = 0.2


@dataclass(frozen=True)
class RobustOptions:
    """
    How RANSAC or another robust estimator is to work; see ``TemplateLocator``.

    Raises
    ------
    TypeError, ValueError
        An option is out of range.
    """

    method: str | int
    threshold: float
    max_iterations: int
    confidence: float
    seed: int

    def __post_init__(self) -> None:
        method_code(self.method)
        if not 0 < self.threshold < math.inf:
            raise ValueError(f"ransac_threshold must be positive, got {self.threshold}")
        if not 0 < self.confidence < 1:
            raise ValueError(f"confidence must be between 0 and 1, got {self.confidence}")
        as_count(self.max_iterations, "max_iterations", 1)
        as_count(self.seed, "seed", 0)


@dataclass(frozen=True, eq=False)
class View:
    """
    A polished homography with its support.

    Attributes
    ----------
    refined : Refined
    inliers : ndarray of bool, shape (N,)
        The pairs within the threshold.
    fault : str
        Why no camera could see it so, or why it is too vague; empty if all is well.
    """

    refined: Refined
    inliers: NDArray[np.bool_]
    fault: str


def fit_view(
    pairs: Pairs, template_size: Size, scene_size: Size, how: RobustOptions
) -> View | None:
    """
    Find the view of the template that most matches agree with.

    Parameters
    ----------
    pairs : Pairs
        Matches, best first.
    template_size, scene_size : tuple of int
        (width, height).
    how : RobustOptions

    Returns
    -------
    View or None
        A possible view if there is one, else the best of the impossible; None without any.
    """
    best: View | None = None
    for members in _candidates(pairs, how.threshold):
        view = _fit(pairs, members, template_size, scene_size, how)
        if view is not None and (best is None or _score(view) > _score(best)):
            best = view
    return best


def _score(view: View) -> tuple[bool, int]:
    return not view.fault, int(np.count_nonzero(view.inliers))


def _candidates(pairs: Pairs, threshold: float) -> Iterator[NDArray[np.intp]]:
    """Yield the sets of matches that RANSAC is tried upon."""
    if pairs.oriented:
        yield from groups(pairs, threshold)
    else:
        yield np.arange(len(pairs))


def _fit(
    pairs: Pairs,
    members: NDArray[np.intp],
    template_size: Size,
    scene_size: Size,
    how: RobustOptions,
) -> View | None:
    source, target = pairs.template_points, pairs.scene_points
    H = estimate(
        source[members],
        target[members],
        method=method_code(how.method),
        threshold=how.threshold,
        max_iterations=how.max_iterations,
        confidence=how.confidence,
        seed=how.seed,
    )
    if H is None:
        return None
    inliers = reprojection_errors(H, source, target) <= how.threshold
    if np.count_nonzero(inliers) < MIN_MATCHES:
        return None
    if outline_fault(H, template_size, scene_size):
        # Too few inliers, too close together, for their perspective to mean anything.
        H = similarity(source[inliers], target[inliers])
    corners = template_corners(template_size).astype(np.float64)
    refined: Refined | None = None
    # The group was an approximation: inliers outside it widen the support.
    for _ in range(2):
        noise = keypoint_noise(H, source[inliers], pairs.noise[inliers])
        polished = refine(H, source[inliers], target[inliers], noise, corners)
        if polished is None:
            break
        refined, H = polished, polished.H
        before, inliers = inliers, reprojection_errors(H, source, target) <= how.threshold
        if np.array_equal(before, inliers) or np.count_nonzero(inliers) < MIN_MATCHES:
            break
    if refined is None:
        return None
    fault = outline_fault(H, template_size, scene_size) or _vagueness(refined, corners)
    return View(refined, inliers, fault)


def _vagueness(refined: Refined, corners: NDArray[np.float64]) -> str:
    """Say so if the inliers leave the outline open."""
    area = cv2.contourArea(project(refined.H, corners).astype(np.float32))
    sigma = float(refined.sigma.max())
    if sigma <= MAX_RELATIVE_SIGMA * math.sqrt(area):
        return ""
    return (
        "degenerate inliers: they cover too little of the template to fix its corners "
        f"(uncertain by {sigma:.0f} pixels)"
    )
