# %%
"""Exercise 4.1."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Final, NamedTuple, Protocol, Sequence

import cv2
import numpy as np
import numpy.typing as npt

from course_lib import drawing
from course_lib import images as course_images

Image = npt.NDArray[np.uint8]
MIN_INLIERS: Final = 10

# %%
class Size(NamedTuple):
    width: int
    height: int


class Detector(Protocol):
    def detectAndCompute(self, image: Image, mask: None) -> tuple[Sequence[cv2.KeyPoint], Image | None]: ...


@dataclass(frozen=True, slots=True)
class Features:
    keypoints: Sequence[cv2.KeyPoint]
    descriptors: Image | None

    @property
    def points(self) -> npt.NDArray[np.float32]:
        return np.array([kp.pt for kp in self.keypoints], dtype=np.float32).reshape(-1, 2)

    def __bool__(self) -> bool:
        return self.descriptors is not None and len(self.keypoints) > 0


@dataclass
class Locator:
    template: Image
    detector: Detector = field(default_factory=lambda: cv2.ORB_create(1200))
    reprojection: float = 4.0

    @cached_property
    def features(self) -> Features:
        return self.describe(self.template)

    def describe(self, image: Image) -> Features:
        return Features(*self.detector.detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None))

    def __call__(self, scene: Image, match_count: int) -> npt.NDArray[np.float32] | None:
        here, there = self.features, self.describe(scene)
        if not (here and there):
            return None
        match match_keypoints(here.descriptors, there.descriptors)[:match_count]:
            case [_, _, _, _, *_] as best:
                a = here.points[[m.queryIdx for m in best]]
                b = there.points[[m.trainIdx for m in best]]
            case _:
                return None
        H, mask = cv2.findHomography(a, b, cv2.USAC_MAGSAC, self.reprojection, confidence=0.999, maxIters=10_000)
        if H is None or (n := int(mask.sum())) < MIN_INLIERS:
            return None
        return self.project(H)

    def project(self, H: npt.NDArray[np.float64]) -> npt.NDArray[np.float32] | None:
        height, width = self.template.shape[:2]
        corners = np.array([[0, 0], [0, height - 1], [width - 1, height - 1], [width - 1, 0]], np.float32)
        found = cv2.perspectiveTransform(corners[None], H)[0]
        return found if cv2.isContourConvex(found) else None

# %%
def load_images(
    folder: Path = course_images.path("ROS.png").parent if hasattr(course_images, "path") else Path("../images"),
) -> tuple[Image, Image]:
    wanted: dict[str, Size] = {"ROS.png": Size(400, 600), "ROS2.png": Size(width=600, height=400)}
    mug, scene = (cv2.resize(cv2.imread(str(Path(folder) / name)), size) for name, size in wanted.items())
    return mug, scene


def find_keypoints(image: Image) -> tuple[Sequence[cv2.KeyPoint], Image | None]:
    found = Locator(image).features
    return found.keypoints, found.descriptors


def match_keypoints(query_descriptors: Image, train_descriptors: Image) -> list[cv2.DMatch]:
    matcher = cv2.BFMatcher.create(cv2.NORM_HAMMING, crossCheck=True)
    return sorted(matcher.match(query_descriptors, train_descriptors), key=lambda m: m.distance)


def locate_mug(mug: Image, scene: Image, match_count: int = 100) -> npt.NDArray[np.float32] | None:
    return Locator(mug)(scene, match_count)

# %%
mug, scene = load_images()
kp, des = find_keypoints(mug)
kps, dess = find_keypoints(scene)
keypoint_picture: Image = cv2.drawKeypoints(mug, kp, None, color=(200, 0, 200))
match_picture: Image = cv2.drawMatches(mug, kp, scene, kps, match_keypoints(des, dess)[:25], None)
outline_picture: Image = cv2.polylines(scene.copy(), [locate_mug(mug, scene).astype(int)], True, (0, 0, 255), 4)
for name, picture in {"keypoints": keypoint_picture, "matches": match_picture, "mug": outline_picture}.items():
    drawing.show(picture, alt=name, title=name)
