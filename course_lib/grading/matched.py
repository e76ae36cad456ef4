"""A submission's list of matches, and what is wrong with it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Points = NDArray[np.float64]

# Pixels between where a match should lead and where it leads.
NEAR = 8.0
# Of the best matches of a right pipeline, the share that is right: 0.35 and more (see thresholds).
BEST, RIGHT = 40, 0.3
# What is sorted by a ratio or by two things is nearly sorted by distance; what is not, is not.
SORTED_CORRELATION = 0.3
# A second-best match this much farther away makes the best one clear; ratio tests allow 0.6 to 0.9.
CLEAR, HALF = 0.6, 0.5
# Descriptors that a matcher takes, and a number of them that it goes through in a second.
_DTYPES, _MOST = (np.uint8, np.float32), 6000
# The share of partners that are used once. Over twelve seeds, a ratio test at 0.85 left 0.65 and
# more of ORB, AKAZE, BRISK and SIFT, by brute force and by FLANN, which overlooks some of the
# second best; no test at all left ORB 0.44 to 0.57, AKAZE 0.42 to 0.59.
ALL_ONCE, NONE_ONCE = 0.65, 0.55
# Detectors describe nearly every place of a picture in another way.
LEAST_DISTINCT = 0.5


class MatchList:
    """What came back as matches.

    Parameters
    ----------
    found : object
        What the submission returned.
    n_query, n_train : int
        How many keypoints there are on each side.

    Attributes
    ----------
    wrong_kind : str or None
        Why these are no matches at all, for the student.
    in_range : bool
        Whether every index counts a keypoint.
    """

    def __init__(self, found: object, n_query: int, n_train: int) -> None:
        self.wrong_kind = _wrong_kind(found)
        self.in_range = False
        if self.wrong_kind is None and isinstance(found, list | tuple):
            self._query = np.array([match.queryIdx for match in found])
            self._train = np.array([match.trainIdx for match in found])
            self._distance = np.array([match.distance for match in found], np.float64)
            inside = (self._query < n_query) & (self._train < n_train)
            self.in_range = bool((inside & (self._query >= 0) & (self._train >= 0)).all())

    def share_right(self, expected: Points, there: Points) -> float:
        """Return 1 when enough of the best matches are right, less when fewer are.

        Parameters
        ----------
        expected : ndarray, shape (n_query, 2)
            Where each query keypoint is in the other picture.
        there : ndarray, shape (n_train, 2)
            The keypoints of the other picture.
        """
        return min(1.0, self._near(expected, there, self._query, self._train) / RIGHT)

    def is_swapped(self, expected: Points, there: Points) -> bool:
        """Tell whether the matches are right the other way round."""
        if self._query.max() >= len(there) or self._train.max() >= len(expected):
            return False
        swapped = self._near(expected, there, self._train, self._query)
        return swapped >= RIGHT > self._near(expected, there, self._query, self._train)

    def takes_bits_for_numbers(self, query: NDArray[Any], train: NDArray[Any]) -> bool:
        """Tell whether the distances do not count bits, though the descriptors are rows of bits."""
        if query.dtype != np.uint8 or train.dtype != np.uint8 or not self.in_range:
            return False
        best = slice(BEST)
        pairs = list(zip(query[self._query[best]], train[self._train[best]], strict=True))
        given = self._distance[best]
        if np.allclose([cv2.norm(*pair, cv2.NORM_HAMMING) for pair in pairs], given):
            return False
        others = (cv2.NORM_L2, cv2.NORM_L1, cv2.NORM_L2SQR, cv2.NORM_HAMMING2)
        return any(
            np.allclose([cv2.norm(*pair, norm) for pair in pairs], given, rtol=1e-4)
            for norm in others
        )

    def _near(
        self, expected: Points, there: Points, query: NDArray[np.int_], train: NDArray[np.int_]
    ) -> float:
        offsets = np.linalg.norm(expected[query[:BEST]] - there[train[:BEST]], axis=1)
        return float((offsets < NEAR).mean())

    def wrong_order(self) -> str | None:
        """Say what is wrong with the order, if anything."""
        if len(self._distance) < 2 or (np.diff(self._distance) >= 0).all():
            return None
        if (np.diff(self._distance) <= 0).all():
            return "The worst matches come first. Sort them by distance, the smallest first."
        by_rank = np.argsort(np.argsort(self._distance, kind="stable"))
        correlation = np.corrcoef(by_rank, np.arange(len(by_rank)))[0, 1]
        if correlation > SORTED_CORRELATION:
            return None
        return "The matches are not sorted. Return sorted(matches, key=lambda m: m.distance)."

    def is_cut_unsorted(self, query: NDArray[Any], train: NDArray[Any]) -> bool:
        """Tell whether these are the first of all cross-checked matches as OpenCV gives them.

        Who cuts off after that many before sorting throws good matches away.
        """
        if not _can_be_matched(query, train):
            return False
        pairs = set(zip(self._query.tolist(), self._train.tolist(), strict=True))
        matches = cv2.BFMatcher(_norm(query), crossCheck=True).match(query, train)
        everything = [(match.queryIdx, match.trainIdx) for match in matches]
        return len(pairs) < len(everything) and pairs == set(everything[: len(pairs)])

    def is_ratio_inverted(self, query: NDArray[Any], train: NDArray[Any]) -> bool:
        """Tell whether the clear matches were thrown away, and the ambiguous ones kept."""
        if not _can_be_matched(query, train):
            return False
        kept = set(self._query.tolist())
        clear: list[bool] = []
        ambiguous: list[bool] = []
        for pair in cv2.BFMatcher(_norm(query)).knnMatch(query, train, k=2):
            if len(pair) == 2:
                some = clear if pair[0].distance < CLEAR * pair[1].distance else ambiguous
                some.append(pair[0].queryIdx in kept)
        return len(clear) > 0 and not any(clear) and bool(np.mean(ambiguous or [False]) > HALF)

    def share_once(self) -> float:
        """Return 1 when hardly any keypoint has two partners, 0 when many have."""
        once = min(len(np.unique(side)) / len(side) for side in (self._query, self._train))
        return float(np.clip((once - NONE_ONCE) / (ALL_ONCE - NONE_ONCE), 0, 1))


def share_distinct(descriptors: NDArray[Any]) -> float:
    """Return which share of the rows is unlike those before."""
    return len({row.tobytes() for row in descriptors}) / max(1, len(descriptors))


def _can_be_matched(query: NDArray[Any], train: NDArray[Any]) -> bool:
    """Tell whether OpenCV takes a student's descriptors, and soon comes to an end with them."""
    alike = query.dtype == train.dtype and query.shape[1] == train.shape[1]
    return bool(alike and query.dtype in _DTYPES and max(len(query), len(train)) <= _MOST)


def _norm(descriptors: NDArray[Any]) -> int:
    return cv2.NORM_HAMMING if descriptors.dtype == np.uint8 else cv2.NORM_L2


def _wrong_kind(found: object) -> str | None:
    if not isinstance(found, list | tuple):
        none = " It returns None: is a return missing?" if found is None else ""
        return f"match_keypoints should return a list of cv2.DMatch.{none}"
    if not found:
        return "match_keypoints found nothing to match, though both pictures show the same mug."
    if isinstance(found[0], list | tuple):
        return "knnMatch returns a list for each keypoint. Keep the best of each, and return those."
    if not all(isinstance(match, cv2.DMatch) for match in found):
        return "match_keypoints should return cv2.DMatch objects, as a matcher gives them."
    return None
