"""Exercise 4.1: the mug found where it is, and not found where it is not."""

from __future__ import annotations

from contextlib import contextmanager
from functools import cache

import cv2
import numpy as np

from course_lib import images
from course_lib.drawing import draw_outline
from course_lib.grading.answers import Answers
from course_lib.grading.geometry import (
    as_outline,
    corner_credit,
    diagnose,
    mug_credit,
    recognise,
)
from course_lib.grading.mistakes import HAS_FOUND
from course_lib.grading.rubric import points
from course_lib.grading.student import Raised
from course_lib.grading.thresholds import MUG_SHELF
from course_lib.homography import project, template_corners
from course_lib.scenes import mug_scene

EXERCISE = "4.1"
MUG_SIZE, SCENE_SIZE = (400, 600), (600, 400)
PRESENT = ("plain", "rotation", "scale", "tilt", "dim", "noise", "cover")
N_ABSENT = 3
# Who finds fewer of the scenes that show the mug says nothing by saying "not there".
FINDS = 0.4
HANDFUL = 5


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
    fraction = corner_credit(found, right, MUG_SHELF)
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
    nearly = _with_a_spot(blank, rng)
    for name, mug, picture in (
        ("a blank scene", scene.mug, blank),
        ("a blank mug", np.full_like(scene.mug, 200), scene.scene),
        ("a scene with a faint spot and nothing else", scene.mug, nearly),
    ):
        with grade.attempt(), _explained(grade, finds):
            found = answers.locate_mug(mug, picture)
            grade.add(
                float(found is None),
                message=None if found is None else f"An outline was returned for {name}.",
            )
    with grade.attempt(), _explained(grade, finds):
        found = student.locate_mug(scene.mug, scene.scene, 3)
        fine = found is None or as_outline(found) is not None
        grade.add(float(fine), message=None if fine else "With 3 matches, return None.")
    _only_if(finds, grade)


@contextmanager
def _explained(grade, finds):
    """Say what an exception comes from that is raised only here."""
    try:
        yield
    except Raised:
        if finds:
            grade.note(
                "Where there is nothing to find, descriptors are None, matches are fewer than "
                "four, and the homography is None: look at each before you use it, and return None."
            )
        raise


def _with_a_spot(blank, rng):
    """Paint the faintest square with a handful of corners: too few inliers, however they lie."""
    y, x = int(rng.integers(100, 300)), int(rng.integers(100, 500))
    size = int(rng.integers(14, 30))
    orb = cv2.ORB_create()
    for contrast in range(16, 120):
        picture = blank.copy()
        picture[y : y + size, x : x + size] -= np.uint8(contrast)
        if len(orb.detect(picture)) >= HANDFUL:
            return picture
    return blank


def _finds(answers, seeds):
    """Tell whether the mug is found where it is, if only by what a mistake has left of it."""
    found = 0.0
    for kind in PRESENT:
        scene = mug_scene(seeds("unseen", kind), kind=kind)
        answer = answers.quietly(scene.mug, scene.scene)
        mistake = recognise(answer, scene.corners, scene.mug.shape, scene.scene.shape)
        found += mistake in HAS_FOUND or mug_credit(answer, scene.corners, kind) > 0
    return found / len(PRESENT) >= FINDS


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
