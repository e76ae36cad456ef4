"""Exercise 4.2, step by step: the notebook, the crop, the choice of a match count."""

from __future__ import annotations

import math
from numbers import Real

from course_lib.grading.geometry import credit
from course_lib.grading.replies import Missing, NotDone, StudentError, TimedOut
from course_lib.grading.rubric import points
from course_lib.grading.thresholds import COUNT_LOSS, FORM
from course_lib.grading.waterhole import Waterhole

EXERCISE = "4.2"
FUNCTIONS = ("crop_waterhole", "locate_waterhole", "best_match_count")
BAD_CELL = 0.25  # what a cell that raises costs, of the point
# Four matches or eight are too few; forty to a hundred serve best.
CANDIDATES = [4, 8, 60, 400]
TURNED = [60, 4]  # now the last is no good
LONGER = 3  # than other calls may take: it is many of them in one


@points(0.5, "4.2.1", "The notebook runs from top to bottom")
def test_runs(student, grade, seeds):
    """Every cell runs, and the three functions are there."""
    hole = Waterhole(student, seeds)
    there = sum(_is_written(name, hole, grade) for name in FUNCTIONS)
    bad = [cell for cell in student.cells if cell.error]
    for cell in bad:
        grade.note(f"Code cell {cell.number} {cell.error}.")
    grade.add(there / len(FUNCTIONS) * max(0.0, 1 - BAD_CELL * len(bad)))


def _is_written(name, hole, grade):
    frame = hole.judged[0]
    try:
        if name == "locate_waterhole":
            hole.locate(frame)
        elif name == "crop_waterhole":
            hole.student.crop_waterhole(frame.image)
        else:
            hole.student.best_match_count(hole.template, [frame.image], [60])
    except (Missing, NotDone) as error:
        grade.note(str(error))
        return False
    except StudentError:
        pass  # there it is; whether it is right is asked elsewhere
    return True


@points(0.5, "4.2.2", "crop_waterhole returns the waterhole, and little else")
def test_crop(student, grade, seeds):
    """Cut from the frame of the published flight that the exercise uses."""
    crop = Waterhole(student, seeds).crop
    grade.add(crop.credit, message=crop.message)


@points(1, "4.2.5", "best_match_count chooses a count that serves on frames it has not seen")
def test_best_match_count(student, grade, seeds):
    """Judged by how well locate_waterhole does with it, against the best of the candidates."""
    hole = Waterhole(student, seeds)
    # No waterhole in the first nor in the last: whoever looks at one frame only learns nothing.
    searched = [hole.absent[0], *hole.searched, hole.absent[-1]]
    best = _ask(student, grade, hole, searched, CANDIDATES)
    # The right one comes first, so that it is not the last.
    known = _is_count(best) and best in CANDIDATES
    again = _ask(student, grade, hole, hole.searched, TURNED) if known else best
    none = " It returns None: is a return missing?" if best is None else ""
    grade.check(_is_count(best), f"best_match_count should return a whole number.{none}")
    place = (
        " Is it the candidate's place in the list, or in how many frames it was found? Return the "
        "candidate itself."
        if best < len(CANDIDATES)
        else ""
    )
    grade.check(
        known and _is_count(again) and again in TURNED,
        "best_match_count returns a count that is not among the candidates it was given. Try each "
        f"of candidates, and no others.{place}",
    )
    fraction = min(_served(hole, int(best), CANDIDATES), _served(hole, int(again), TURNED))
    grade.add(fraction * (1.0 if isinstance(best, int) else FORM))
    if not isinstance(best, int):
        grade.note("best_match_count returns a float. A count is an int: matches[:60.0] fails.")
    if fraction < 1:
        grade.note(_why(int(best), int(again)))
    if not hole.finds():
        grade.lose("The choice counts once locate_waterhole finds the waterhole.")


def _is_count(value):
    """Tell whether something is a whole number: no array, no truth value, neither NaN nor inf."""
    number = isinstance(value, Real) and not isinstance(value, bool)
    return number and math.isfinite(value) and value == int(value)


def _ask(student, grade, hole, frames, candidates):
    try:
        return student.best_match_count(
            hole.template,
            [frame.image for frame in frames],
            list(candidates),
            timeout=LONGER * student.seconds,
        )
    except TimedOut:
        grade.note(
            "Does the loop come to an end, whatever is found? Then, to find a picture's keypoints "
            "once is enough: for the template, and for each frame."
        )
        raise


def _served(hole, count, candidates):
    """Return how well a choice does on other frames, against the best of the candidates."""
    reached = hole.quality(count)
    possible = 1.0
    if 1 - reached > COUNT_LOSS.full:
        possible = max(map(hole.quality, candidates))
    return credit(possible - reached, COUNT_LOSS)


def _why(best, again):
    if (best, again) == (CANDIDATES[-1], TURNED[-1]):
        return (
            "best_match_count returns the last candidate, whatever it is. Keep the best while the "
            "loop goes on, and return that: is `return` behind the loop, and of the right name?"
        )
    if (best, again) == (CANDIDATES[0], TURNED[0]):
        return (
            "best_match_count returns the first candidate, whatever it is. Is `return` inside the "
            "loop, or does the comparison never hold? A share of inliers says nothing: count the "
            "frames in which the outline is believable."
        )
    if min(best, again) == min(CANDIDATES):
        return (
            "Any four matches agree with their own homography, so a share of inliers says nothing: "
            "count the frames in which the outline is believable."
        )
    return (
        "On other frames of a flight, other candidates do better than your choice. Let each "
        "candidate count in how many of all the frames a believable outline is found."
    )
