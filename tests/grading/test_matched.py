"""What a list of matches tells: a ratio test is one, on every scene."""

from __future__ import annotations

import cv2
import pytest

from course_lib.grading.matched import MatchList
from course_lib.scenes import mug_scene

# OpenCV 5 has moved it.
AKAZE = getattr(cv2, "AKAZE_create", None) or cv2.xfeatures2d.AKAZE_create


def features(detector, picture):
    return detector.detectAndCompute(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), None)


@pytest.mark.parametrize(("ratio", "share"), [(0.85, 1.0), (None, 0.0)])
@pytest.mark.parametrize("seed", range(1000, 1012))
def test_a_ratio_test_keeps_each_keypoint_once_enough(seed, ratio, share):
    scene = mug_scene(seed, kind="plain")
    for make in (cv2.ORB_create, AKAZE):
        (here, query), (there, train) = (
            features(make(), each) for each in (scene.mug, scene.scene)
        )
        pairs = cv2.BFMatcher(cv2.NORM_HAMMING).knnMatch(query, train, k=2)
        kept = [m for m, n in pairs if ratio is None or m.distance < ratio * n.distance]
        found = MatchList(kept, len(here), len(there)).share_once()
        assert found == share if ratio else found < 0.4
