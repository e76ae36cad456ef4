"""Exercise 4.1: the mug found where it is, and not found where it is not."""

from __future__ import annotations

from collections import Counter
from contextlib import contextmanager, suppress
from functools import cache

import cv2
import numpy as np

from course_lib import images
from course_lib.drawing import draw_outline
from course_lib.grading.answers import Answers
from course_lib.grading.geometry import (
    absent_credit,
    as_outline,
    corner_credit,
    diagnose,
    mug_credit,
    recognise,
)
from course_lib.grading.mistake_texts import MESSAGES
from course_lib.grading.mistakes import HAS_FOUND
from course_lib.grading.replies import Raised, StudentError
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
HANDFUL = 5
BLANK = 200  # grey level
# What these say of a wrong outline fits many mistakes.
VAGUE = ("far", "folded", "near")


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
def test_shelf(student, grade, seeds):
    """The exercise's own pictures."""
    mug, shelf, right = _published()
    answers = Answers(student)
    found = answers.locate_mug(mug, shelf)
    fraction = corner_credit(found, right, MUG_SHELF)
    grade.add(fraction)
    if fraction < 1:
        grade.note(_help_on_shelf(found, answers, seeds) or _help(found, right, mug, shelf))
    grade.scene("the shelf", _drawn(shelf, right, found))


@points(2, "4.1.6", "locate_mug finds the mug in pictures you have not seen")
def test_unseen_scenes(student, grade, seeds):
    """Other mugs, other backgrounds: turned, far away, from the side, in dim light, covered."""
    answers = Answers(student)
    scenes = _unseen(seeds)
    for scene in scenes.values():
        answers.quietly(scene.mug, scene.scene)
    # Then what each looks like says nothing.
    same = answers.all_the_same()

    @cache
    def elsewhere():
        return _finds_nothing(answers, seeds) or _looks_elsewhere(answers)

    for kind, scene in scenes.items():
        with grade.attempt():
            found = answers.locate_mug(scene.mug, scene.scene)
            fraction = mug_credit(found, scene.corners, kind)
            wrong = None
            if fraction < 1 and not same:
                wrong = elsewhere() or _help_unseen(found, scene, answers, seeds)
            grade.add(fraction, message=wrong)
            grade.scene(kind, _drawn(scene.scene, scene.corners, found))
    if same:
        grade.note(
            "Your function gives the same answer for different pictures. Does it use its "
            "arguments, mug and scene, or variables of the notebook? Does it keep what it found "
            "the first time?"
        )


@points(1, "4.1.7", "locate_mug returns None where there is no mug")
def test_absent(student, grade, seeds):
    """Shelves without the mug. Counts only for who finds the mug where it is."""
    answers = Answers(student)
    finds = _finds(answers, seeds)
    for number in range(N_ABSENT):
        scene = mug_scene(seeds("absent", number), kind="absent")
        with grade.attempt(), _explained(grade, finds):
            found = answers.locate_mug(scene.mug, scene.scene)
            wrong = diagnose(found, None, scene.mug.shape, scene.scene.shape)
            grade.add(absent_credit(found), message=wrong)
            grade.scene("no mug", _drawn(scene.scene, None, found))
    _only_if(finds, grade)


@points(1, "4.1.8", "locate_mug copes with pictures in which there is nothing to match")
def test_nothing_to_match(student, grade, seeds):
    """Blank pictures and very few matches: None or an outline, but no exception."""
    answers = Answers(student)
    finds = _finds(answers, seeds)
    scene = mug_scene(seeds("unseen", "plain"), kind="plain")
    blank = np.full_like(scene.scene, BLANK)
    rng = np.random.default_rng(seeds("blank"))
    nearly = _with_a_spot(blank, rng)
    for name, mug, picture in (
        ("a blank scene", scene.mug, blank),
        ("a blank mug", np.full_like(scene.mug, BLANK), scene.scene),
        ("a scene with a faint spot and nothing else", scene.mug, nearly),
    ):
        with grade.attempt(), _explained(grade, finds):
            found = answers.locate_mug(mug, picture)
            wrong = None if found is None else f"An outline was returned for {name}."
            if found is not None and absent_credit(found):
                wrong = diagnose(found, None, mug.shape, picture.shape)
            grade.add(absent_credit(found), message=wrong)
    with grade.attempt(), _explained(grade, finds):
        found = student.locate_mug(scene.mug, scene.scene, 3)
        fine = 1.0 if as_outline(found) is not None else absent_credit(found)
        grade.add(fine, message=None if fine == 1 else "With 3 matches, return None.")
    _only_if(finds, grade)


@contextmanager
def _explained(grade, finds):
    """Say what an exception comes from that is raised only here."""
    try:
        yield
    except Raised as error:
        if error.on_purpose:
            grade.note("Where there is nothing to find, return None instead of raising an error.")
        elif finds:
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
    for kind, scene in _unseen(seeds).items():
        answer = answers.quietly(scene.mug, scene.scene)
        mistake = recognise(answer, scene.corners, scene.mug.shape, scene.scene.shape)
        found += mistake in HAS_FOUND or mug_credit(answer, scene.corners, kind) > 0
    return found / len(PRESENT) >= FINDS


def _unseen(seeds):
    return {kind: mug_scene(seeds("unseen", kind), kind=kind) for kind in PRESENT}


def _finds_nothing(answers, seeds):
    """Say so of a function that returns None even for the mug's own picture: no match can be bad.

    Then it is no fault of the matches, but of what is done with the result.
    """
    scenes = list(_unseen(seeds).values())
    with suppress(StudentError):
        asked = [(scene.mug, scene.scene) for scene in scenes] + [(scenes[0].mug, scenes[0].mug)]
        if all(answers.ask("locate_mug", *both) is None for both in asked):
            return MESSAGES["never"].format(thing="mug")
    return None


def _looks_elsewhere(answers):
    """Say so of a function that finds the notebook's mug without being given both pictures."""
    mug, shelf, right = _published()
    for name, both in (
        ("scene", (mug, np.full_like(shelf, BLANK))),
        ("mug", (np.full_like(mug, BLANK), shelf)),
    ):
        if corner_credit(answers.quietly(*both), right, MUG_SHELF):
            return (
                f"Your function finds the notebook's mug even when its argument {name} is a blank "
                f"picture: it, or a function that it calls, uses a variable of the notebook "
                f"instead of {name}, or what follows from it, such as its keypoints."
            )
    return None


def _help_on_shelf(found, answers, seeds):
    """Say what is wrong where a print is flat, if on the shelf it cannot be told.

    There it is bent round the mug, which blurs what a mistake looks like.
    """
    mug, shelf, right = _published()
    if found is None:
        return _finds_nothing(answers, seeds)
    vague = recognise(found, right, mug.shape, shelf.shape) in VAGUE
    return _named_elsewhere(answers, seeds) if vague else None


def _help_unseen(found, scene, answers, seeds):
    """Say what is wrong; where that is vague, what is wrong in other scenes."""
    vague = recognise(found, scene.corners, scene.mug.shape, scene.scene.shape) in VAGUE
    other = _named_elsewhere(answers, seeds) if vague else None
    return other or _help(found, scene.corners, scene.mug, scene.scene)


def _named_elsewhere(answers, seeds):
    """Return the text of the mistake that is recognised most often, if any is."""
    mistakes = Counter()
    for scene in _unseen(seeds).values():
        answer = answers.quietly(scene.mug, scene.scene)
        mistakes[recognise(answer, scene.corners, scene.mug.shape, scene.scene.shape)] += 1
    named = [each for each, _ in mistakes.most_common() if each in HAS_FOUND and each not in VAGUE]
    return MESSAGES[named[0]].format(thing="mug") if named else None


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
