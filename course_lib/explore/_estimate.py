"""The unit's own estimate (best matches, RANSAC, outline), for every setting of a slider."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib.homography import project, template_corners
from course_lib.matching import match_brute_force
from course_lib.outline import outline_fault

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

# Four inliers prove nothing, since any four matches agree with some homography.
MIN_INLIERS = 7


@dataclass(frozen=True)
class Pairing:
    """Cross-checked ORB matches of two pictures, best first.

    Attributes
    ----------
    template_points, scene_points
        float32 of shape (N, 2): the i-th match joins the i-th points.
    template_size, scene_size
        (width, height) in pixels.
    """

    template_points: NDArray[np.float32]
    scene_points: NDArray[np.float32]
    template_size: tuple[int, int]
    scene_size: tuple[int, int]

    def __len__(self) -> int:
        return len(self.template_points)


@dataclass(frozen=True)
class Estimate:
    """What RANSAC makes of some matches.

    Attributes
    ----------
    corners
        float32 of shape (4, 2) in scene pixels, or None when there is no homography.
    inliers
        bool of shape (n,).
    fault
        Why the outline is not to be believed; empty when it was found.
    """

    corners: NDArray[np.float32] | None
    inliers: NDArray[np.bool_]
    fault: str
    H: NDArray[np.float64] | None = None


class Pairer:
    """ORB and cross-checked brute force against one template, as Example 4.4 writes it."""

    def __init__(self, template: NDArray[np.uint8], n_features: int = 1000) -> None:
        self._orb = cv2.ORB_create(n_features)  # type: ignore[attr-defined]
        self._size = (template.shape[1], template.shape[0])
        self._keypoints, self._descriptors = self._detect(template)

    def _detect(
        self, image: NDArray[np.uint8]
    ) -> tuple[Sequence[cv2.KeyPoint], NDArray[np.uint8] | None]:
        return self._orb.detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)  # type: ignore[no-any-return]

    def pair(self, scene: NDArray[np.uint8]) -> Pairing:
        """Match the template with a BGR scene."""
        keypoints, descriptors = self._detect(scene)
        matches = match_brute_force(self._descriptors, descriptors)
        here = [self._keypoints[m.queryIdx].pt for m in matches]
        there = [keypoints[m.trainIdx].pt for m in matches]
        return Pairing(
            np.array(here, np.float32).reshape(-1, 2),
            np.array(there, np.float32).reshape(-1, 2),
            self._size,
            (scene.shape[1], scene.shape[0]),
        )


def estimate(pairing: Pairing, count: int, threshold: float) -> Estimate:
    """Fit a homography to the best `count` matches and judge its outline."""
    here, there = pairing.template_points[:count], pairing.scene_points[:count]
    none = np.zeros(len(here), np.bool_)
    if len(here) < 4:
        return Estimate(None, none, "too few matches")
    found, mask = cv2.findHomography(here, there, cv2.RANSAC, threshold)
    if found is None or mask is None:
        return Estimate(None, none, "no homography fits")
    H = np.asarray(found, np.float64)
    inliers = mask.ravel().astype(np.bool_)
    fault = outline_fault(H, pairing.template_size, pairing.scene_size) or ""
    if not fault and inliers.sum() < MIN_INLIERS:
        fault = "too few inliers to be believed"
    with np.errstate(divide="ignore", invalid="ignore"):
        corners = project(H, template_corners(pairing.template_size)).astype(np.float32)
    return Estimate(corners, inliers, fault.split(":")[0], H)
