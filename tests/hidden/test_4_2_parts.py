"""Exercise 4.2, step by step: the notebook, the crop, the choice of a match count."""

from __future__ import annotations

from numbers import Real

from course_lib.grading.geometry import credit
from course_lib.grading.rubric import points
from course_lib.grading.student import Missing, NotDone, StudentError
from course_lib.grading.thresholds import COUNT_LOSS
from course_lib.grading.waterhole import Waterhole

EXERCISE = "4.2"
FUNCTIONS = ("crop_waterhole", "locate_waterhole", "best_match_count")
BAD_CELL = 0.25  # what a cell that raises costs, of the point
# Four matches or eight are too few; forty to a hundred serve best.
CANDIDATES = [4, 8, 60, 400]
SEARCH_S = 60.0  # more than for other calls: it is many of them in one


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
    best = student.best_match_count(
        hole.template,
        [frame.image for frame in searched],
        list(CANDIDATES),
        timeout=SEARCH_S,
    )
    number = isinstance(best, Real) and not isinstance(best, bool) and best == int(best)
    grade.check(number, "best_match_count should return a whole number.")
    grade.check(
        best in CANDIDATES,
        "best_match_count returns a count that is not among the candidates it was given. Try each "
        "of candidates, and no others.",
    )
    reached = hole.quality(int(best))
    possible = 1.0
    if 1 - reached > COUNT_LOSS.full:
        possible = max(map(hole.quality, CANDIDATES))
    fraction = credit(possible - reached, COUNT_LOSS)
    grade.add(fraction)
    if fraction < 1:
        grade.note(
            "Any four matches agree with their own homography, so a share of inliers says "
            "nothing: count the frames in which the outline is believable."
            if best == min(CANDIDATES)
            else "On other frames of a flight, other candidates do better than your choice. Let "
            "each candidate count in how many of all the frames a believable outline is found."
        )
    if not hole.finds():
        grade.lose("The choice counts once locate_waterhole finds the waterhole.")
