"""A few questions about Exercise 4.1, asked where how a grading ends is the point, not its points.

They touch everything that a submission sends: cells, calls, keypoints, matches, outlines, pictures.
"""

from __future__ import annotations

import cv2
import numpy as np

from course_lib.grading.geometry import diagnose, mug_credit
from course_lib.grading.matched import MatchList
from course_lib.grading.rubric import points
from course_lib.scenes import mug_scene

EXERCISE = "4.1"
FUNCTIONS = ("load_images", "find_keypoints", "match_keypoints", "locate_mug")


@points(1, "4.1.1", "The notebook runs from top to bottom")
def test_runs(student, grade):
    names = set(student.names)
    bad = [cell for cell in student.cells if cell.error]
    for cell in bad:
        grade.note(f"Code cell {cell.number} {cell.error}.")
    there = sum(name in names for name in FUNCTIONS)
    grade.add(there / len(FUNCTIONS) * max(0.0, 1 - 0.25 * len(bad)))


def _pair(found, grade):
    grade.check(isinstance(found, tuple | list) and len(found) == 2, "not two things")
    return found


@points(1, "4.1.2", "load_images returns two pictures")
def test_load_images(student, grade):
    mug, scene = _pair(student.load_images(), grade)
    grade.check(isinstance(mug, np.ndarray) and mug.shape == (600, 400, 3), "no mug")
    grade.check(isinstance(scene, np.ndarray) and scene.shape == (400, 600, 3), "no scene")


@points(1, "4.1.3", "Keypoints and matches belong together")
def test_matches(student, grade, seeds):
    scene = mug_scene(seeds("quick"), kind="plain")
    (here, query), (there, train) = (
        _pair(student.find_keypoints(picture), grade) for picture in (scene.mug, scene.scene)
    )
    for some in (here, there):
        keypoints = isinstance(some, list | tuple) and all(
            isinstance(one, cv2.KeyPoint) for one in some
        )
        grade.check(keypoints, "no keypoints")
    matches = MatchList(student.match_keypoints(query, train), len(here), len(there))
    grade.check(not matches.wrong_kind, matches.wrong_kind)
    grade.check(matches.in_range and not matches.wrong_order(), "not sorted")


@points(2, "4.1.4", "locate_mug finds the mug")
def test_locate(student, grade, seeds):
    for kind in ("plain", "rotation"):
        scene = mug_scene(seeds("quick"), kind=kind)
        with grade.attempt():
            found = student.locate_mug(scene.mug, scene.scene)
            grade.add(
                mug_credit(found, scene.corners, kind),
                message=diagnose(found, scene.corners, scene.mug.shape, scene.scene.shape),
            )


@points(1, "4.1.5", "The mug is drawn")
def test_drawn(student, grade):
    drawn = [picture for picture in student.pictures if picture.shape == (600, 400, 3)]
    grade.check(drawn, "no picture is as large as the mug")
