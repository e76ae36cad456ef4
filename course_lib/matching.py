"""Brute-force matching of descriptors: every query against every train descriptor."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from course_lib import hamming

Descriptors = NDArray[Any]

# cv2.BFMatcher packs the train index into 18 bits.
MAX_DESCRIPTORS = (1 << 18) - 1


def match_brute_force(
    query: Descriptors | None,
    train: Descriptors | None,
    *,
    cross_check: bool = True,
    ratio: float | None = None,
    norm: int | None = None,
) -> list[cv2.DMatch]:
    """
    Match descriptors to their nearest neighbours, best match first.

    Parameters
    ----------
    query, train : ndarray, shape (N, D) and (M, D), or None
        uint8 for packed binary descriptors (ORB, BRIEF, AKAZE), float32 for others (SIFT).
        None, which OpenCV returns when it finds no keypoint, is an empty set.
    cross_check : bool
        Keep a match only if each descriptor is the other's nearest neighbour.
    ratio : float or None
        Keep a match only if its distance is less than ``ratio`` times that of the second nearest
        train descriptor [1]_ (0.7 to 0.8 is usual). A sole train descriptor has no rival and
        passes.
    norm : int or None
        ``cv2.NORM_…``; None takes NORM_HAMMING for uint8 and NORM_L2 for float32. ORB with
        ``WTA_K`` of 3 or 4 needs NORM_HAMMING2.

    Returns
    -------
    list of cv2.DMatch
        Sorted by distance, ties by query index. ``queryIdx`` counts in ``query``, ``trainIdx`` in
        ``train``.

    Raises
    ------
    TypeError
        Not arrays, or of different or unknown dtypes.
    ValueError
        Not two-dimensional, of different lengths D, more than 262143 rows, or a ratio out of
        (0, 1].

    References
    ----------
    .. [1] D. G. Lowe, "Distinctive Image Features from Scale-Invariant Keypoints", IJCV 60(2),
       2004, section 7.1.

    Examples
    --------
    >>> import numpy as np
    >>> query = np.array([[0b1111_0000], [0b0000_0001]], np.uint8)
    >>> train = np.array([[0b0000_0000], [0b1111_0001]], np.uint8)
    >>> [(m.queryIdx, m.trainIdx, m.distance) for m in match_brute_force(query, train)]
    [(0, 1, 1.0), (1, 0, 1.0)]
    """
    if ratio is not None and not 0 < ratio <= 1:
        raise ValueError(f"ratio must be above 0 and at most 1, got {ratio}")
    _check(query, "query")
    _check(train, "train")
    if query is None or train is None or len(query) == 0 or len(train) == 0:
        return []
    if query.dtype != train.dtype:
        raise TypeError(
            f"query is {query.dtype} but train is {train.dtype}: "
            "did two different detectors describe them?"
        )
    if query.shape[1] != train.shape[1]:
        raise ValueError(
            f"query descriptors are {query.shape[1]} long, train descriptors {train.shape[1]}"
        )
    if norm is None:
        norm = cv2.NORM_HAMMING if query.dtype == np.uint8 else cv2.NORM_L2
    matches = _nearest(query, train, norm, cross_check=cross_check, ratio=ratio)
    matches.sort(key=lambda match: match.distance)
    return matches


def _nearest(
    query: Descriptors, train: Descriptors, norm: int, *, cross_check: bool, ratio: float | None
) -> list[cv2.DMatch]:
    if ratio is None:
        if cross_check and norm == cv2.NORM_HAMMING and hamming.available(query, train):
            found = hamming.mutual_nearest(query, train)
            rows = zip(*(column.tolist() for column in found), strict=True)
            return [cv2.DMatch(q, t, distance) for q, t, distance in rows]
        return list(cv2.BFMatcher(norm, crossCheck=cross_check).match(query, train))
    # knnMatch refuses k=2 together with crossCheck, so the check is a second, backward pass.
    matcher = cv2.BFMatcher(norm)
    kept = [
        pair[0]
        for pair in matcher.knnMatch(query, train, k=2)
        if len(pair) == 1 or pair[0].distance < ratio * pair[1].distance
    ]
    if cross_check:
        back = {match.queryIdx: match.trainIdx for match in matcher.match(train, query)}
        kept = [match for match in kept if back[match.trainIdx] == match.queryIdx]
    return kept


def _check(descriptors: Descriptors | None, name: str) -> None:
    if descriptors is None:
        return
    if not isinstance(descriptors, np.ndarray):
        raise TypeError(
            f"{name} must be an array of descriptors, got {type(descriptors).__name__}; "
            "detectAndCompute returns (keypoints, descriptors)"
        )
    if descriptors.size == 0:
        return
    if descriptors.ndim != 2:
        raise ValueError(f"{name} must have shape (N, D), got {descriptors.shape}")
    if descriptors.dtype not in (np.uint8, np.float32):
        raise TypeError(f"{name} must be uint8 or float32, got {descriptors.dtype}")
    if len(descriptors) > MAX_DESCRIPTORS:
        raise ValueError(
            f"{name} has {len(descriptors)} descriptors; OpenCV matches up to {MAX_DESCRIPTORS}"
        )
