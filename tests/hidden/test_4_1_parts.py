"""Exercise 4.1, step by step: the notebook, its pictures, its keypoints."""

from __future__ import annotations

import cv2
import numpy as np

from course_lib import images
from course_lib.grading.matched import LEAST_DISTINCT, share_distinct
from course_lib.grading.replies import Missing, NotDone, StudentError
from course_lib.grading.rubric import points
from course_lib.scenes import mug_scene

EXERCISE = "4.1"
MUG_SIZE, SCENE_SIZE = (400, 600), (600, 400)
FUNCTIONS = ("load_images", "find_keypoints", "match_keypoints", "locate_mug")
BAD_CELL = 0.25  # what a cell that raises costs, of the point
# Mean difference in grey levels between a picture and itself, resized in another way: under 5.
SAME_PICTURE = 12.0
LEAST_KEYPOINTS = 50
TOO_FEW = 400  # whom ORB's detector is allowed no more hardly finds the mug
# From this share of rows on that ORB gives again, they are ORB's.
SURELY_ORB = 0.6


@points(1, "4.1.1", "The notebook runs from top to bottom")
def test_runs(student, grade):
    """Every cell runs, and the four functions are there."""
    there = sum(_is_written(student, name, grade) for name in FUNCTIONS)
    reasons = _reasons([cell for cell in student.cells if cell.error], grade)
    grade.add(there / len(FUNCTIONS) * max(0.0, 1 - BAD_CELL * reasons))


def _reasons(bad, grade):
    """Say why cells failed, and count the reasons: what one cell lacks fails many."""
    own = [cell for cell in bad if cell is bad[0] or "raised NameError" not in cell.error]
    for cell in own:
        grade.note(f"Code cell {cell.number} {cell.error}.")
    if others := [str(cell.number) for cell in bad if cell not in own]:
        grade.note(f"After that, a name was missing in code cell {', '.join(others)}.")
    return len({cell.error for cell in own})


def _is_written(student, name, grade):
    mug, scene = _published()
    arguments = {"load_images": (), "find_keypoints": (mug,), "locate_mug": (mug, scene)}
    try:
        if name == "match_keypoints":
            few = np.zeros((0, 32), np.uint8)
            student.match_keypoints(few, few)
        else:
            student.call(name, *arguments[name])
    except (Missing, NotDone) as error:
        grade.note(str(error))
        return False
    except StudentError:
        pass  # there it is; whether it is right is asked elsewhere
    return True


def _published():
    mug, scene = images.load("ROS.png"), images.load("ROS2.png")
    return images.resize(mug, *MUG_SIZE), images.resize(scene, *SCENE_SIZE)


@points(1, "4.1.2", "load_images returns the mug and the scene at the right sizes")
def test_load_images(student, grade):
    """Both pictures, in colour (BGR), the mug 400 x 600 and the scene 600 x 400."""
    found = student.load_images()
    pair = isinstance(found, tuple | list) and len(found) == 2
    none = " It returns None: is the return missing?" if found is None else ""
    grade.check(pair, f"load_images should return two pictures: return mug, scene.{none}")
    right = _published()
    for picture, expected, name in zip(found, right, ("mug", "scene"), strict=True):
        wrong = _wrong_picture(picture, expected, name, right)
        grade.add(0.0 if wrong else 1.0, message=wrong)


def _wrong_picture(picture, expected, name, right):
    if not isinstance(picture, np.ndarray) or picture.dtype != np.uint8:
        return f"The {name} should be a picture: an array of uint8, as cv2.imread returns it."
    height, width = expected.shape[:2]
    if picture.shape == (height, width):
        return f"The {name} is grey. Return it in colour (BGR); grey comes later."
    if picture.shape == (width, height, 3):
        other = right[1] if expected is right[0] else right[0]
        if picture.shape == other.shape and _difference(picture, other) <= SAME_PICTURE:
            return "Mug and scene are in the wrong order: return mug, scene."
        return (
            f"Width and height of the {name} are swapped. cv2.resize takes (width, height); "
            "an array's shape is (height, width)."
        )
    if picture.shape != expected.shape:
        return f"The {name} should be {width} wide and {height} high, in colour. Resize it."
    if _difference(picture, expected) <= SAME_PICTURE:
        return None
    if _difference(picture[..., ::-1], expected) <= SAME_PICTURE:
        return f"The {name} is RGB. Leave it BGR, as OpenCV loads it."
    return f"The {name} is another picture than it should be, or more was done to it than resizing."


def _difference(a, b):
    return float(np.abs(a.astype(np.int16) - b).mean())


@points(1, "4.1.3", "find_keypoints returns keypoints and a descriptor for each")
def test_find_keypoints(student, grade, seeds):
    """Keypoints lie in the picture and belong to their descriptors; a blank picture is no error."""
    parts = mug_scene(seeds("parts"), kind="plain")
    mug, scene = parts.mug, parts.scene
    found = student.find_keypoints(mug)
    pair = isinstance(found, tuple | list) and len(found) == 2
    none = " It returns None: is the return missing?" if found is None else ""
    grade.check(
        pair, f"find_keypoints should return two things: return keypoints, descriptors.{none}"
    )
    keypoints, descriptors = found
    swapped = isinstance(keypoints, np.ndarray) and not isinstance(descriptors, np.ndarray)
    grade.check(not swapped, "Keypoints come first: return keypoints, descriptors.")
    are_keypoints = isinstance(keypoints, list | tuple) and all(
        isinstance(each, cv2.KeyPoint) for each in keypoints
    )
    grade.check(
        are_keypoints, "The first result should be cv2.KeyPoint objects, as ORB gives them."
    )
    belong = isinstance(descriptors, np.ndarray) and descriptors.ndim == 2
    belong = belong and len(descriptors) == len(keypoints)
    grade.check(
        belong,
        "There should be one row of descriptors for each keypoint. Take both from one call: "
        "orb.detectAndCompute(gray, None).",
    )
    grade.check(
        _in_one_order(mug, keypoints, descriptors),
        "The descriptors are in another order than the keypoints: the i-th row should belong to "
        "the i-th keypoint. Were the keypoints sorted on their own?",
    )
    places = np.array([each.pt for each in keypoints]).reshape(-1, 2)
    inside = (places >= -0.5) & (places <= np.array(MUG_SIZE) - 0.5)
    grade.check(
        inside.all(),
        "Some keypoints lie outside the picture that was given. Does find_keypoints use its "
        "argument, in its own size?",
    )
    grade.check(
        len(descriptors) == 0 or share_distinct(descriptors) >= LEAST_DISTINCT,
        "Most rows of the descriptors are the same: they should describe what is around each "
        "keypoint.",
    )
    many = min(1.0, len(keypoints) / LEAST_KEYPOINTS)
    few = "There are very few keypoints. Is the picture right that reaches the detector?"
    grade.add(many, out_of=0.8, message=few if many < 1 else None)
    if _used_wrong_grey(mug, keypoints, descriptors):
        grade.note("The pictures are BGR: convert with cv2.COLOR_BGR2GRAY, not RGB2GRAY.")
    if _stops_early(student, keypoints, scene):
        grade.note(
            f"find_keypoints stops at {len(keypoints)} keypoints, and most of them go to the books "
            "around the mug. Allow more: cv2.ORB_create(1000)."
        )
    with grade.attempt(out_of=0.2):
        student.find_keypoints(np.full_like(mug, 200))
        grade.add(1.0, out_of=0.2)


def _stops_early(student, keypoints, scene):
    """Tell whether another picture has as many keypoints: as many as the detector was allowed."""
    if len(keypoints) >= TOO_FEW:
        return False
    try:
        others = student.find_keypoints(scene)[0]
    except (StudentError, TypeError, IndexError):
        return False
    return isinstance(others, list | tuple) and len(others) == len(keypoints)


def _may_be_orb(keypoints, descriptors):
    """Tell whether OpenCV can be asked to describe these keypoints once more.

    It looks up what it is told to: numbers that ORB never gives would lead it astray.
    """
    usual = all(
        0 <= each.octave < 32 and 0 <= each.angle <= 360 and np.isfinite(each.pt).all()
        for each in keypoints
    )
    return usual and descriptors.dtype == np.uint8 and descriptors.shape[1] == 32


def _in_one_order(mug, keypoints, descriptors):
    """Tell whether ORB's descriptors, if it is ORB, stand in the order of their keypoints."""
    if not _may_be_orb(keypoints, descriptors):
        return True
    orb = cv2.ORB_create(max(len(keypoints), 1))
    again, described = orb.compute(cv2.cvtColor(mug, cv2.COLOR_BGR2GRAY), keypoints)
    if described is None:
        return True
    at = {_place(each): row.tobytes() for each, row in zip(again, described, strict=True)}
    given = [row.tobytes() for row in descriptors]
    known = set(at.values()).intersection(given)
    right = sum(at.get(_place(each)) == row for each, row in zip(keypoints, given, strict=True))
    return len(known) < SURELY_ORB * len(given) or right > len(known) / 2


def _place(keypoint):
    return (*keypoint.pt, keypoint.octave)


def _used_wrong_grey(mug, keypoints, descriptors):
    """Tell whether ORB's keypoints are those of the picture with red and blue exchanged."""
    if not _may_be_orb(keypoints, descriptors):
        return False
    orb = cv2.ORB_create(max(len(keypoints), 1))
    red_for_blue = cv2.cvtColor(mug, cv2.COLOR_RGB2GRAY)
    _, described = orb.compute(red_for_blue, keypoints)
    return described is not None and np.array_equal(described, descriptors)
