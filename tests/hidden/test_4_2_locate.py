"""Exercise 4.2: the waterhole found where it is, and not found where it is not."""

from __future__ import annotations

import cv2
import numpy as np

from course_lib.grading.geometry import absent_credit, as_outline, diagnose
from course_lib.grading.replies import StudentError
from course_lib.grading.rubric import points
from course_lib.grading.waterhole import OTHER_TEMPLATE, Waterhole, judge

EXERCISE = "4.2"
ENDS = (3, 4, 1000)
FEWEST = 3  # matches: no homography follows from so few


@points(1.5, "4.2.3", "locate_waterhole finds the waterhole in a flight you have not seen")
def test_unseen_flight(student, grade, seeds):
    """With the student's own crop as the template. Not every frame need be right."""
    hole = Waterhole(student, seeds)
    judge(
        grade,
        hole.judged,
        hole.locate,
        hole.expected,
        hole.template.shape,
        home=hole.home,
        nothing=hole.finds_nothing(),
    )
    if not hole.crop.usable:
        grade.note(OTHER_TEMPLATE)
    for frame in hole.judged[::3]:
        grade.scene("the waterhole", _drawn(hole, frame))
    if hole.answers.all_the_same():
        grade.note(
            "Your function gives the same answer for different frames. Does it use its "
            "arguments, template and frame, or variables of the notebook?"
        )


@points(1, "4.2.4", "locate_waterhole returns None without a waterhole, whatever the match count")
def test_nothing_to_find(student, grade, seeds):
    """Frames without the well, a blank one, very few matches and very many. No exception."""
    hole = Waterhole(student, seeds)
    finds = hole.finds()
    for frame in hole.absent:
        with grade.attempt():
            found = hole.locate(frame)
            wrong = diagnose(found, None, hole.template.shape, frame.image.shape, thing="waterhole")
            grade.add(absent_credit(found), message=wrong)
            grade.scene("no waterhole", _drawn(hole, frame))
    blank = np.full_like(hole.judged[0].image, 200)
    with grade.attempt():
        found = student.locate_waterhole(hole.template, blank, 100)
        said = None if found is None else "An outline was returned for a blank picture."
        if found is not None and absent_credit(found):
            said = diagnose(found, None, hole.template.shape, blank.shape, thing="waterhole")
        grade.add(absent_credit(found), message=said)
    for count in ENDS:
        with grade.attempt(out_of=0.5):
            found = hole.locate(hole.judged[0], count)
            outline = as_outline(found) is not None
            fine = 1.0 if outline and count > FEWEST else absent_credit(found)
            said = f"With match_count={count}, return four corners (4, 2), or None."
            if outline:
                said = (
                    f"With match_count={count} an outline was returned, though a homography needs "
                    "four matches. Does your function use its argument match_count?"
                )
            grade.add(fine, out_of=0.5, message=None if fine == 1 else said)
    if not finds:
        grade.lose("Saying None counts once the waterhole is found in the frames that show it.")


def _drawn(hole, frame):
    try:
        found = as_outline(hole.locate(frame))
    except StudentError:
        found = None
    picture = frame.image.copy()
    for outline, colour in ((hole.expected(frame), (0, 255, 0)), (found, (0, 0, 255))):
        if outline is not None and np.abs(outline).max() < 1e4:
            corners = np.rint(outline).astype(np.int32)
            cv2.polylines(picture, [corners], isClosed=True, color=colour, thickness=3)
    return picture
