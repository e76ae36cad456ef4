"""Exercise 4.1: the three pictures that the notebook draws."""

from __future__ import annotations

import numpy as np

from course_lib import images
from course_lib.grading.drawn import largest_set, lines_cross, sightings
from course_lib.grading.published_flight import photo_boxes
from course_lib.grading.replies import StudentError
from course_lib.grading.rubric import points

EXERCISE = "4.1"
# Of a picture's pixels: fewer changed ones mean that nothing was drawn on it. Fifty keypoints
# change 0.0024 of the mug, an outline one pixel wide, which is what cv2.polylines draws by itself,
# 0.002 and more of the scene; a picture that is only resized or saved as JPEG, nothing at all.
DRAWN_ON, OUTLINED = 0.002, 0.0015
SMALLEST, LARGEST = 100, 2000  # pixels of a side
WANTED = (
    "the keypoints of the mug",
    "the matches between mug and scene",
    "the mug outlined in the scene",
)


@points(1, "4.1.9", "Three pictures: keypoints, matches, the outlined mug")
def test_three_pictures(student, grade):
    """Found among all that the notebook drew, whatever its size and style."""
    mug, scene = _as_loaded(student)
    fits = []
    for picture in student.pictures[::-1]:
        fits += _could_be(picture, mug, scene)
        if largest_set(fits) == len(WANTED):
            return
    grade.add(largest_set(fits) / len(WANTED))
    for number, name in enumerate(WANTED):
        if not any(could[number] for could in fits):
            grade.note(
                f"No picture shows {name}. Draw it, with cv2 or matplotlib, and run the cell."
            )


def _as_loaded(student):
    """Return the exercise's pictures in the sizes that the student gave them, right or wrong."""
    pictures = [images.load("ROS.png"), images.load("ROS2.png")]
    sizes = [(400, 600), (600, 400)]
    try:
        found = student.load_images()
    except StudentError:
        found = None
    if isinstance(found, tuple | list) and len(found) == 2:
        for number, own in enumerate(found):
            shape = getattr(own, "shape", ())
            if len(shape) in {2, 3} and all(SMALLEST <= side <= LARGEST for side in shape[:2]):
                sizes[number] = (shape[1], shape[0])
    return [images.resize(p, *size) for p, size in zip(pictures, sizes, strict=True)]


def _could_be(picture, mug, scene):
    """Return what each part of a picture could be: keypoints, matches, outline."""
    places = photo_boxes(picture)
    mugs = [m for m in sightings(picture, mug, places=places) if m.drawn > DRAWN_ON]
    scenes = sightings(picture, scene, places=places)
    # The mug that stands in the scene is not a mug of its own.
    mugs = [one for one in mugs if not any(_middle_inside(one.box, s.box) for s in scenes)]
    scenes = [seen for seen in scenes if seen.drawn > OUTLINED]
    parts = []
    boxes = [seen.box for seen in (*mugs, *scenes)]
    for one in list(mugs):
        ratio = mug.shape[1] / scene.shape[1]
        beside = [s for s in scenes if _beside(one.box, s.box, ratio)]
        beside += [
            s
            for s in scenes
            if _neighbours(one.box, s.box, boxes) and lines_cross(picture, one.box, s.box)
        ]
        if beside:
            parts.append(np.array([False, True, False]))
            mugs.remove(one)
            scenes.remove(beside[0])
    # One figure with several axes holds several pictures.
    parts += [np.array([True, False, False])] * len(mugs)
    return parts + [np.array([False, False, True])] * len(scenes)


def _middle_inside(inner, outer):
    x, y = (inner[0] + inner[2]) / 2, (inner[1] + inner[3]) / 2
    return outer[0] <= x <= outer[2] and outer[1] <= y <= outer[3]


def _neighbours(one, other, boxes):
    """Tell whether no further picture stands between two."""
    hull = (*map(min, one[:2], other[:2]), *map(max, one[2:], other[2:]))
    return not any(_middle_inside(box, hull) for box in boxes if box not in {one, other})


def _beside(mug, scene, ratio):
    """Tell whether a mug and a scene touch and have one scale, as in cv2.drawMatches."""
    near = 0.12 * (mug[2] - mug[0])
    side_by_side = min(abs(mug[2] - scene[0]), abs(scene[2] - mug[0])) < near
    return side_by_side and 0.8 < (mug[2] - mug[0]) / (scene[2] - scene[0]) / ratio < 1.25
