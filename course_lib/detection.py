"""The answer to the question where a template is in a scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import cv2
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Detection:
    """
    Where the template is in the scene; falsy when it was not found.

    Attributes
    ----------
    found : bool
    reason : str
        Why it was not found; empty when it was.
    corners : ndarray of float32, shape (4, 2), or None
        The template's corners in scene pixels (x, y): top-left, bottom-left, bottom-right,
        top-right of the template. None when not found.
    homography : ndarray of float64, shape (3, 3), or None
        H_scene_from_template, with H[2, 2] = 1. None when not found.
    matches : tuple of cv2.DMatch
        The matches used, best first; ``queryIdx`` counts template keypoints, ``trainIdx`` scene
        keypoints.
    inliers : ndarray of bool, shape (len(matches),)
        Which matches agree with the homography. When not found: with the rejected one.
    template_keypoints, scene_keypoints : tuple of cv2.KeyPoint
    log10_false_alarms : float
        Base-10 logarithm of the expected number of such agreements by chance alone (see
        :mod:`course_lib.evidence`); infinite when no homography was judged.
    corner_sigma : float
        Standard deviation of the least certain corner in pixels, as the inliers' spread and noise
        tell; infinite when not found.
    """

    found: bool
    reason: str
    corners: NDArray[np.float32] | None = None
    homography: NDArray[np.float64] | None = None
    matches: tuple[cv2.DMatch, ...] = ()
    inliers: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, np.bool_))
    template_keypoints: tuple[cv2.KeyPoint, ...] = ()
    scene_keypoints: tuple[cv2.KeyPoint, ...] = ()
    log10_false_alarms: float = np.inf
    corner_sigma: float = np.inf

    def __bool__(self) -> bool:
        return self.found

    def __repr__(self) -> str:
        agreed = f"{self.inlier_count} inliers of {len(self.matches)} matches"
        return f"Detection(found, {agreed})" if self else f"Detection(not found: {self.reason})"

    @property
    def inlier_count(self) -> int:
        """How many matches agree with the homography."""
        return int(np.count_nonzero(self.inliers))
