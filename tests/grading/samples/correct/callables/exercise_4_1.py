# %%
from functools import partial
from operator import attrgetter

import cv2
import numpy as np

from course_lib import drawing, images, localize

# %%
load = lambda name, size: cv2.resize(images.load(name), size, interpolation=cv2.INTER_AREA)
load_images = lambda: (load("ROS.png", (400, 600)), load("ROS2.png", (600, 400)))
describe = lambda detector, image: detector.detectAndCompute(image, mask=None)
find_keypoints = partial(describe, cv2.SIFT_create(1500))


class Pairs(cv2.BFMatcher):
    def __call__(self, one, other):
        if one is None or other is None:
            return []
        return sorted(self.match(one, other), key=attrgetter("distance"))


match_keypoints = Pairs(cv2.NORM_L2, crossCheck=True)


class Finder:
    options = {"detector": "SIFT"}

    def locate(self, mug, scene, match_count=100):
        if match_count < 4:
            return None
        detection = localize.locate_template(mug, scene, match_count=match_count, **self.options)
        return detection.corners.astype(float) if detection else None


locate_mug = Finder().locate

# %%
mug, scene = load_images()
(kp, des), (kps, dess) = map(find_keypoints, (mug, scene))
drawing.show(
    [
        cv2.drawKeypoints(mug, kp, None, flags=cv2.DrawMatchesFlags_DRAW_RICH_KEYPOINTS),
        cv2.drawMatches(mug, kp, scene, kps, match_keypoints(des, dess)[:50], None),
        drawing.draw_outline(scene, locate_mug(mug, scene)),
    ],
    alt="All three in one picture",
)
