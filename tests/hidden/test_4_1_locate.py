"""Exercise 4.1: the mug found where it is, and not found where it is not."""

from __future__ import annotations

from functools import cache

import numpy as np

from course_lib import images
from course_lib.drawing import draw_outline
from course_lib.grading.answers import Answers
from course_lib.grading.geometry import as_outline, corner_error, credit, diagnose, mug_credit
from course_lib.grading.rubric import points
from course_lib.grading.thresholds import MUG_SHELF
from course_lib.homography import project, template_corners
from course_lib.scenes import mug_scene

EXERCISE = "4.1"
MUG_SIZE, SCENE_SIZE = (400, 600), (600, 400)
PRESENT = ("plain", "rotation", "scale", "tilt", "dim", "noise", "cover")
N_ABSENT = 3
# Who finds fewer of the scenes that show the mug says nothing by saying "not there".
FINDS = 0.4


@cache
def _published():
    mug = images.resize(images.load("ROS.png"), *MUG_SIZE)
    shelf = images.resize(images.load("ROS2.png"), *SCENE_SIZE)
    H = np.array(images.truth("ROS2.png")["objects"]["mug"]["homography_print"])
    # Both pictures shrink to two thirds, about the pixels' own corners.
    shrink = np.array([[2 / 3, 0, -1 / 6], [0, 2 / 3, -1 / 6], [0, 0, 1.0]])
    corners = template_corners(MUG_SIZE).astype(np.float64)
    return mug, shelf, project(shrink @ H @ np.linalg.inv(shrink), corners)


@points(1, "4.1.5", "locate_mug finds the mug on the shelf")
def test_shelf(student, grade):
    """The exercise's own pictures."""
    mug, shelf, right = _published()
    found = student.locate_mug(mug, shelf)
    fraction = credit(corner_error(found, right), MUG_SHELF)
    grade.add(fraction, message=_help(found, right, mug, shelf) if fraction < 1 else None)
    grade.scene("the shelf", _drawn(shelf, right, found))


@points(2, "4.1.6", "locate_mug finds the mug in pictures you have not seen")
def test_unseen_scenes(student, grade, seeds):
    """Other mugs, other backgrounds: turned, far away, from the side, in dim light, covered."""
    answers = Answers(student)
    for kind in PRESENT:
        scene = mug_scene(seeds("unseen", kind), kind=kind)
        with grade.attempt():
            found = answers.locate_mug(scene.mug, scene.scene)
            fraction = mug_credit(found, scene.corners, kind)
            wrong = _help(found, scene.corners, scene.mug, scene.scene) if fraction < 1 else None
            grade.add(fraction, message=wrong)
            grade.scene(kind, _drawn(scene.scene, scene.corners, found))
    if answers.all_the_same():
        grade.note(
            "Your function gives the same answer for different pictures. Does it use its "
            "arguments, mug and scene, or variables of the notebook?"
        )


@points(1, "4.1.7", "locate_mug returns None where there is no mug")
def test_absent(student, grade, seeds):
    """Shelves without the mug. Counts only for who finds the mug where it is."""
    answers = Answers(student)
    finds = _finds(answers, seeds)
    for number in range(N_ABSENT):
        scene = mug_scene(seeds("absent", number), kind="absent")
        with grade.attempt():
            found = answers.locate_mug(scene.mug, scene.scene)
            wrong = diagnose(found, None, scene.mug.shape, scene.scene.shape)
            grade.add(float(found is None), message=wrong)
            grade.scene("no mug", _drawn(scene.scene, None, found))
    _only_if(finds, grade)


@points(1, "4.1.8", "locate_mug copes with pictures in which there is nothing to match")
def test_nothing_to_match(student, grade, seeds):
    """Blank pictures and very few matches: None or an outline, but no exception."""
    answers = Answers(student)
    finds = _finds(answers, seeds)
    scene = mug_scene(seeds("unseen", "plain"), kind="plain")
    blank = np.full_like(scene.scene, 200)
    rng = np.random.default_rng(seeds("blank"))
    nearly = blank.copy()
    y, x = int(rng.integers(100, 300)), int(rng.integers(100, 500))
    nearly[y : y + 40, x : x + 40] = rng.integers(0, 255, (40, 40, 3), np.uint8)
    for name, mug, picture in (
        ("a blank scene", scene.mug, blank),
        ("a blank mug", np.full_like(scene.mug, 200), scene.scene),
        ("a scene with one small patch", scene.mug, nearly),
    ):
        with grade.attempt():
            found = answers.locate_mug(mug, picture)
            grade.add(
                float(found is None),
                message=None if found is None else f"An outline was returned for {name}.",
            )
    with grade.attempt():
        found = student.locate_mug(scene.mug, scene.scene, 3)
        fine = found is None or as_outline(found) is not None
        grade.add(float(fine), message=None if fine else "With 3 matches, return None.")
    _only_if(finds, grade)


def _finds(answers, seeds):
    reached = 0.0
    for kind in PRESENT:
        scene = mug_scene(seeds("unseen", kind), kind=kind)
        reached += mug_credit(answers.quietly(scene.mug, scene.scene), scene.corners, kind)
    return reached / len(PRESENT) >= FINDS


def _only_if(finds, grade):
    if not finds:
        grade.lose("Saying None counts once the mug is found in the pictures that show it.")


def _help(found, right, mug, scene):
    return diagnose(found, right, mug.shape, scene.shape)


def _drawn(scene, right, found):
    picture = scene if right is None else draw_outline(scene, right)
    outline = as_outline(found)
    if outline is None or np.abs(outline).max() > 1e5:
        return picture
    return draw_outline(picture, outline, color=(0, 0, 255))
