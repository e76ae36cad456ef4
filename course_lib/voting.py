"""
Group matches that tell of the same movement, before any homography is fitted.

RANSAC needs four inliers in one draw. With 10 inliers of 100 that is one draw in ten thousand, and
with 2000 draws it mostly fails. But an ORB, SIFT or AKAZE keypoint has a size and an angle, so a
single match already tells a whole similarity: where, how large, how turned. Lowe lets matches vote
in a Hough space of such similarities [1]_; here each match predicts where every other should be,
which needs no bins. Within the largest group most matches are inliers, and few draws suffice.

References
----------
.. [1] D. G. Lowe, "Distinctive Image Features from Scale-Invariant Keypoints", IJCV 60(2), 2004,
   sections 7.3 and 7.4.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from course_lib.pairs import Pairs

# How far a neighbour may be from where a similarity predicts it, in parts of its distance: a tilt
# of 40 degrees shortens distances by a quarter.
SHAPE_TOLERANCE = 0.25
# One octave and 35 degrees between two matches: about the bins of Lowe's (factor 2, 30 degrees),
# and enough for what tilting does to the angles within one template.
GROWTH_TOLERANCE_LOG2 = 1.0
TURN_TOLERANCE = np.deg2rad(35.0)
# Only the best matches propose a movement (all may join), so that time and memory stay linear.
MAX_VOTERS = 256
MAX_GROUPS = 4
MIN_GROUP = 5


def groups(pairs: Pairs, threshold: float) -> Iterator[NDArray[np.intp]]:
    """
    Yield groups of matches that agree on a movement, the largest first.

    Parameters
    ----------
    pairs : Pairs
        With sizes and angles.
    threshold : float
        The inlier threshold in scene pixels.

    Yields
    ------
    ndarray of int, shape (M,)
        Indices into the pairs, ascending (best match first).
    """
    agrees = _agreement(pairs, threshold)
    weights = _weights(pairs, threshold)
    free = np.ones(len(agrees), np.bool_)
    unclaimed = np.ones(len(pairs), np.bool_)
    for _ in range(MAX_GROUPS):
        votes = np.where(free, agrees @ (weights * unclaimed), 0.0)
        leader = int(np.argmax(votes))
        if votes[leader] < 2:
            return
        members = agrees[leader]
        if np.count_nonzero(members) >= MIN_GROUP:
            yield np.flatnonzero(members)
        unclaimed &= ~members
        free &= ~members[: len(free)]
        free[leader] = False


def _agreement(pairs: Pairs, threshold: float) -> NDArray[np.bool_]:
    """Row i: which matches agree with the similarity that match i tells."""
    voters = slice(0, MAX_VOTERS)
    # Complex numbers turn a similarity into one product: scene = z * template + shift.
    source = _complex(pairs.template_points)
    target = _complex(pairs.scene_points)
    z = (pairs.growth * np.exp(1j * pairs.turn)).astype(np.complex64)
    offsets = source[None, :] - source[voters, None]
    errors = np.abs(target[None, :] - target[voters, None] - z[voters, None] * offsets)
    reach = np.abs(z)[voters, None] * np.abs(offsets)
    growth = np.log2(pairs.growth)
    turn = np.angle(z[None, :] / z[voters, None])
    return np.asarray(
        (errors < SHAPE_TOLERANCE * reach + 2 * threshold)
        & (np.abs(growth[None, :] - growth[voters, None]) < GROWTH_TOLERANCE_LOG2)
        & (np.abs(turn) < TURN_TOLERANCE)
    )


def _weights(pairs: Pairs, threshold: float) -> NDArray[np.float64]:
    """Share one vote among matches of the same corner, which ORB finds in several octaves."""
    cells = np.floor(pairs.scene_points / threshold).astype(np.int64)
    _, which, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    return np.asarray(1.0 / counts[which.ravel()], np.float64)


def _complex(points: NDArray[np.float64]) -> NDArray[np.complex64]:
    return np.asarray(points[:, 0] + 1j * points[:, 1], np.complex64)
