"""Exercise 4.2: the three pictures that the notebook draws."""

from __future__ import annotations

import numpy as np

from course_lib.grading.drawn import largest_set, sightings
from course_lib.grading.plots import shows_plot
from course_lib.grading.published_flight import frames_shown, photo_boxes
from course_lib.grading.rubric import points
from course_lib.grading.waterhole import Waterhole

EXERCISE = "4.2"
# Of a picture's pixels: fewer changed ones mean that nothing was drawn on it. An outline one pixel
# wide around a small waterhole still changes 0.2 %, keypoints far more.
OUTLINED, DRAWN_ON = 0.0015, 0.01
AT_THE_WELL = 0.55  # of what was drawn; of a grid, two fifths are
ANOTHER = 0.4  # so many changed: it is another frame
WANTED = (
    "the keypoints of the waterhole",
    "the waterhole outlined in a frame of the flight",
    "how the result varies with the match count, as a plot",
)


@points(0.5, "4.2.6", "Three pictures: keypoints, the outlined waterhole, the plot")
def test_three_pictures(student, grade, seeds):
    """Found among all that the notebook drew, whatever its size and style."""
    template = Waterhole(student, seeds).drawn_on
    fits = []
    for picture in student.pictures[::-1]:
        fits += _could_be(picture, template)
        if largest_set(fits) == len(WANTED):
            return
    grade.add(largest_set(fits) / len(WANTED))
    for number, name in enumerate(WANTED):
        if not any(could[number] for could in fits):
            grade.note(
                f"No picture shows {name}. Draw it, with cv2 or matplotlib, and run the cell."
            )


def _could_be(picture, template):
    """Return what each part of a picture could be: keypoints, outline, plot."""
    frames = frames_shown(picture)
    outlined = [
        one for one in frames if OUTLINED < one.drawn < ANOTHER and one.about_well > AT_THE_WELL
    ]
    parts = [np.array([False, True, False])] * len(outlined)
    # The waterhole that stands in a frame is not a picture of its own.
    alone = [
        seen
        for seen in sightings(picture, template, places=photo_boxes(picture))
        if seen.drawn > DRAWN_ON and not any(_middle_inside(seen.box, one.box) for one in frames)
    ]
    parts += [np.array([True, False, False])] * len(alone)
    if shows_plot(picture):
        parts.append(np.array([False, False, True]))
    return parts


def _middle_inside(inner, outer):
    x, y = (inner[0] + inner[2]) / 2, (inner[1] + inner[3]) / 2
    return outer[0] <= x <= outer[2] and outer[1] <= y <= outer[3]
