"""Matched keypoints as arrays: where they are in both pictures, how large, and how turned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    import cv2
    from numpy.typing import NDArray

    from course_lib.detectors import Features


@dataclass(frozen=True, eq=False)
class Pairs:
    """
    N matches between a template and a scene, best first.

    Attributes
    ----------
    template_points, scene_points : ndarray of float64, shape (N, 2)
        Positions (x, y) in pixels.
    growth : ndarray of float64, shape (N,)
        How many times as large the keypoint is in the scene; NaN where unknown.
    turn : ndarray of float64, shape (N,)
        By how much its angle differs in the scene, in radians, clockwise on screen; NaN where the
        detector gives no angle.
    template_angles : ndarray of float64, shape (N,)
        The keypoint's angle in the template, in radians, clockwise on screen from the x axis.
    noise : ndarray of float64, shape (N, 2)
        Keypoint sizes in template and scene. A keypoint is localised to a fraction of its size.
    """

    template_points: NDArray[np.float64]
    scene_points: NDArray[np.float64]
    growth: NDArray[np.float64]
    turn: NDArray[np.float64]
    template_angles: NDArray[np.float64]
    noise: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.template_points)

    @property
    def oriented(self) -> bool:
        """Whether the detector gives every keypoint a size and an angle."""
        return bool(np.isfinite(self.growth).all() and np.isfinite(self.turn).all())

    @classmethod
    def of(cls, matches: Sequence[cv2.DMatch], template: Features, scene: Features) -> Pairs:
        """Collect what the matches (template is query, scene is train) say as arrays."""
        query = [match.queryIdx for match in matches]
        train = [match.trainIdx for match in matches]
        # float32 attributes of OpenCV objects, read for the matched keypoints only.
        shape = np.array(
            [
                (a.size, b.size, a.angle, b.angle)
                for a, b in (
                    (template.keypoints[i], scene.keypoints[j])
                    for i, j in zip(query, train, strict=True)
                )
            ],
            np.float64,
        ).reshape(-1, 4)
        sizes, angles = shape[:, :2], np.deg2rad(shape[:, 2:])
        with np.errstate(divide="ignore", invalid="ignore"):
            growth = np.where((sizes > 0).all(axis=1), sizes[:, 1] / sizes[:, 0], np.nan)
        # OpenCV marks a missing angle with -1.
        known = (angles >= 0).all(axis=1)
        return cls(
            template_points=template.points[query].astype(np.float64).reshape(-1, 2),
            scene_points=scene.points[train].astype(np.float64).reshape(-1, 2),
            growth=growth,
            turn=np.where(known, angles[:, 1] - angles[:, 0], np.nan),
            template_angles=angles[:, 0],
            noise=sizes,
        )
