"""
Decide whether chance could explain that so many matches agree with one homography.

A fixed number of inliers is a poor rule: 9 of 25 matches within 5 pixels is overwhelming, 9 of 500
is not. The usual linear rule, inliers > 8 + 0.3 x matches [1]_, was made for photographs that
overlap and refuses 20 of 100, which is what a small object among clutter gives. We count false
alarms instead (a-contrario, [2]_): how many homographies with so many inliers would be expected
if all matches were accidents?
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from course_lib.detectors import Features


def false_alarms(
    H: NDArray[np.float64],
    inliers: NDArray[np.bool_],
    template: Features,
    scene: Features,
    query: NDArray[np.intp],
    train: NDArray[np.intp],
    *,
    threshold: float,
) -> float:
    """
    Return log10 of the expected number of chance agreements as good as this; below 0 is evidence.

    With n matches, k of which agree, and p the chance that one accidental match agrees, there are
    C(n, k) choices of inliers and C(k, 4) choices of the four that define H; the other k - 4 must
    agree by chance: NFA = (n - 4) C(n, k) C(k, 4) p^(k - 4) ([2]_ with 4 pairs for a homography).

    References
    ----------
    .. [1] M. Brown, D. G. Lowe, "Automatic Panoramic Image Stitching using Invariant Features",
       IJCV 74(1), 2007.
    .. [2] L. Moisan, B. Stival, "A Probabilistic Criterion to Detect Rigid Point Matches Between
       Two Images and Estimate the Fundamental Matrix", IJCV 57(3), 2004.
    """
    del H
    n = len(query)
    spots = np.unique(np.rint(template.points[query[inliers]] / threshold), axis=0)
    targets = np.unique(np.rint(scene.points[train[inliers]] / threshold), axis=0)
    k = min(len(spots), len(targets))
    if k <= 4:
        return math.inf
    area = scene.size[0] * scene.size[1]
    p = min(1.0, math.pi * threshold**2 / area * 4)
    return math.log10(n - 4) + _log10_choose(n, k) + _log10_choose(k, 4) + (k - 4) * math.log10(p)


def _log10_choose(n: int, k: int) -> float:
    return (math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)) / math.log(10)
