"""Exercise 4.1, step by step: the matches."""

from __future__ import annotations

import cv2
import numpy as np

from course_lib.grading.matched import LEAST_DISTINCT, MatchList, share_distinct
from course_lib.grading.replies import StudentError
from course_lib.grading.rubric import points
from course_lib.homography import project
from course_lib.scenes import mug_scene

EXERCISE = "4.1"


def _features(student, pictures):
    """Find keypoints as the student does, or with ORB: matching is not to suffer for them."""
    try:
        found = [student.find_keypoints(picture) for picture in pictures]
    except StudentError:
        found = []
    if found and all(map(_are_features, found)):
        return found
    grey = [cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY) for picture in pictures]
    return [cv2.ORB_create(1000).detectAndCompute(each, None) for each in grey]


def _are_features(found):
    if not isinstance(found, tuple | list) or len(found) != 2:
        return False
    keypoints, descriptors = found
    if not isinstance(keypoints, tuple | list) or not isinstance(descriptors, np.ndarray):
        return False
    several = descriptors.ndim == 2 and len(descriptors) == len(keypoints) >= 4
    return several and all(isinstance(each, cv2.KeyPoint) for each in keypoints)


@points(1, "4.1.4", "match_keypoints returns good matches, each once, the best first")
def test_match_keypoints(student, grade, seeds):
    """A match is right when both of its points are the same on the mug; where that is known."""
    scene = mug_scene(seeds("parts"), kind="plain")
    (keypoints, query), (others, train) = _features(student, (scene.mug, scene.scene))
    matches = MatchList(student.match_keypoints(query, train), len(keypoints), len(others))
    grade.check(not matches.wrong_kind, matches.wrong_kind)
    here, there = (np.array([each.pt for each in some]) for some in (keypoints, others))
    expected = project(scene.homography, here)
    grade.check(
        matches.in_range and not matches.is_swapped(expected, there),
        "Query and train are swapped: queryIdx should count the first descriptors that "
        "match_keypoints is given, trainIdx the second.",
    )
    wrong = matches.wrong_order()
    if not wrong and matches.is_cut_unsorted(query, train):
        wrong = (
            "Matches are cut off before they are sorted, so that good ones are thrown away. Sort "
            "all of them first, then take the first."
        )
    grade.add(0.0 if wrong else 1.0, out_of=0.35, message=wrong)
    once = matches.share_once()
    alone = "Many keypoints share one partner. Ask both ways: crossCheck=True, or a ratio test."
    if matches.is_ratio_inverted(query, train):
        once = 0.0
        alone = (
            "The ratio test is the wrong way round: the clear matches are thrown away. Keep m when "
            "it is much nearer than the second best, n: m.distance < 0.75 * n.distance."
        )
    grade.add(once, out_of=0.35, message=alone if once < 1 else None)
    if matches.takes_bits_for_numbers(query, train):
        grade.note("These descriptors are rows of bits: compare them with cv2.NORM_HAMMING.")
    right = matches.share_right(expected, there)
    astray = (
        "Few of your best matches are right. Is the norm that of the descriptors, do descriptors "
        "and keypoints belong together, and are all matches sorted?"
    )
    grade.add(right, out_of=0.3, message=astray if right < 1 else None)
    if not right and share_distinct(query) < LEAST_DISTINCT:
        # In order, and each once, is also what was made up.
        grade.lose("Most descriptors are the same, so their matches say nothing.")
