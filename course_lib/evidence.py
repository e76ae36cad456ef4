"""
Decide whether chance could explain that so many matches agree with one homography.

A fixed number of inliers is a poor rule: 9 of 25 matches within 5 pixels is overwhelming, 9 of 500
is not. The usual linear rule, inliers > 8 + 0.3 x matches [1]_, was made for photographs that
overlap, and refuses 20 of 100, which is what a small object among clutter gives. So we count false
alarms (a-contrario, [2]_): if all matches were accidents, how many homographies that so many of
them obey would be expected? Below a tenth, we believe what we see.

Two things make the count honest. Keypoints also have a size and an angle, and an inlier's must
change as the homography says it does there; accidents rarely pass that. And one corner is often
found in several octaves: such matches are not independent, and count once.

References
----------
.. [1] M. Brown, D. G. Lowe, "Automatic Panoramic Image Stitching using Invariant Features",
   IJCV 74(1), 2007, section 3.2.
.. [2] L. Moisan, B. Stival, "A Probabilistic Criterion to Detect Rigid Point Matches Between Two
   Images and Estimate the Fundamental Matrix", IJCV 57(3), 2004.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from course_lib.homography import jacobians

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from course_lib.pairs import Pairs

# log10 of the expected number of false alarms below which a detection is believed: one accident in
# ten scenes without the object would come this far, and of those nearly all have an outline that
# no camera could see (0 of 360 unrelated scenes pass both in the tests).
BELIEVED = -1.0

# How far size and angle may be from what the homography predicts. Wide: octaves are 1.2 apart for
# ORB, and tilted corners change their angle.
GROWTH_TOLERANCE_LOG2 = 0.75
TURN_TOLERANCE = np.deg2rad(30.0)
# The chance that an accident passes: 60 of 360 degrees; and 1.5 of the about 3 octaves that
# keypoints spread over, small ones being more frequent.
TURN_CHANCE = 1 / 6
GROWTH_CHANCE = 1 / 2


def consistent(H: NDArray[np.float64], pairs: Pairs) -> NDArray[np.bool_]:
    """
    Tell which matches' size and angle change as the homography says.

    Parameters
    ----------
    H : ndarray, shape (3, 3)
        H_scene_from_template.
    pairs : Pairs
        Matches; an unknown size or angle is not held against them.

    Returns
    -------
    ndarray of bool, shape (N,)
    """
    J = jacobians(H, pairs.template_points)
    areas = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
    pointing = np.stack([np.cos(pairs.template_angles), np.sin(pairs.template_angles)], axis=1)
    mapped = np.einsum("nij,nj->ni", J, pointing)
    turned = np.arctan2(mapped[:, 1], mapped[:, 0]) - pairs.template_angles
    with np.errstate(divide="ignore", invalid="ignore"):
        off_growth = np.abs(np.log2(pairs.growth) - np.log2(np.abs(areas)) / 2)
        off_turn = np.abs(np.angle(np.exp(1j * (pairs.turn - turned))))
    # Written so that NaN, an unknown size or angle, passes.
    return np.asarray(~(off_growth > GROWTH_TOLERANCE_LOG2) & ~(off_turn > TURN_TOLERANCE))


def distinct(points: NDArray[np.float64], radius: float) -> int:
    """Return how many of the points, taken in order, are farther than ``radius`` from all kept."""
    kept: list[tuple[float, float]] = []
    limit = radius * radius
    for x, y in points.tolist():
        if all((x - u) ** 2 + (y - v) ** 2 > limit for u, v in kept):
            kept.append((x, y))
    return len(kept)


def log10_false_alarms(
    H: NDArray[np.float64],
    pairs: Pairs,
    inliers: NDArray[np.bool_],
    scene_points: NDArray[np.float32],
    scene_size: tuple[int, int],
    threshold: float,
) -> float:
    """
    Return log10 of the expected number of chance agreements as good as this one.

    With n matches, k of which agree, and p the chance that an accident agrees, there are C(n, k)
    choices of who agrees and C(k, 4) of the four that define H; the other k - 4 must agree by
    chance. NFA = (n - 4) C(n, k) C(k, 4) p^(k - 4): Moisan and Stival's, with the four pairs that
    a homography needs.

    Parameters
    ----------
    H : ndarray, shape (3, 3)
        H_scene_from_template.
    pairs : Pairs
        All n matches.
    inliers : ndarray of bool, shape (n,)
        Matches within ``threshold`` of H.
    scene_points : ndarray, shape (M, 2)
        All keypoints of the scene: where accidents can land.
    scene_size : tuple of int
        (width, height).
    threshold : float
        In scene pixels.

    Returns
    -------
    float
        Infinite when there is nothing beyond the four pairs that fit any homography.
    """
    n = len(pairs)
    agreeing = inliers & consistent(H, pairs)
    k = min(
        distinct(pairs.template_points[agreeing], radius_in_template(H, pairs, threshold)),
        distinct(pairs.scene_points[agreeing], threshold),
    )
    if k <= 4 or n <= 4:
        return math.inf
    chance = landing_chance(scene_points, scene_size, threshold)
    if np.isfinite(pairs.turn).all():
        chance *= TURN_CHANCE
    if np.isfinite(pairs.growth).all():
        chance *= GROWTH_CHANCE
    return (
        math.log10(n - 4)
        + _log10_choose(n, k)
        + _log10_choose(k, 4)
        + (k - 4) * math.log10(min(chance, 1.0))
    )


def radius_in_template(H: NDArray[np.float64], pairs: Pairs, threshold: float) -> float:
    """Return the scene's threshold in template pixels, where the matches are."""
    J = jacobians(H, pairs.template_points)
    areas = np.abs(J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0])
    return threshold / math.sqrt(max(float(np.median(areas)), 1e-6))


def landing_chance(
    scene_points: NDArray[np.float32], scene_size: tuple[int, int], threshold: float
) -> float:
    """
    Return the chance that an accidental match ends within ``threshold`` of a given keypoint.

    Keypoints bunch on texture, so the disc's share of the picture would be too small; we count how
    often two keypoints fall in the same cell, whose side is the threshold.
    """
    disc = math.pi * threshold**2
    uniform = disc / (scene_size[0] * scene_size[1])
    count = len(scene_points)
    if count < 2:
        return min(uniform, 1.0)
    cells = np.floor(scene_points / threshold).astype(np.int64)
    _, counts = np.unique(cells[:, 0] * (1 << 32) + cells[:, 1], return_counts=True)
    together = float(np.sum(counts * (counts - 1))) / (count * (count - 1))
    return min(max(uniform, math.pi * together), 1.0)


def _log10_choose(n: int, k: int) -> float:
    return (math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)) / math.log(10)
