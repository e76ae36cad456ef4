"""The hidden tests of Exercise 4.1: fair to what is right, clear about what is wrong."""

from __future__ import annotations

import pytest
from hidden_runs import by_number, edited, graded, lost

from course_lib.grading.sandbox import Launcher, Limits

NOTEBOOK = "exercise_4_1.ipynb"
NUMBERS = {f"4.1.{number}" for number in range(1, 10)}


@pytest.fixture(scope="module")
def launcher():
    with Launcher("bubblewrap", Limits()) as launcher:
        yield launcher


@pytest.mark.parametrize(
    "seed", [b"first of three seeds", b"second of three seeds", b"the third seed!!"]
)
def test_the_solution_gets_every_point(tmp_path, launcher, seed):
    result = graded(edited(NOTEBOOK, tmp_path, ()), "4.1", launcher, seed)
    assert by_number(result).keys() == NUMBERS
    assert lost(result) == set(), [test for test in result.tests if test.score < test.max_score]
    assert result.max_score == 10
    assert result.events == ()


def test_what_is_not_begun_is_not_yet(tmp_path, launcher):
    result = graded(edited(NOTEBOOK, tmp_path, (), "exercises"), "4.1", launcher)
    assert result.score == 0
    assert all("not done yet" in test.output for test in result.tests if test.number < "4.1.7")
    assert not any(test.status == "not_checked" for test in result.tests)


def test_nothing_handed_in(tmp_path, launcher):
    (tmp_path / "in").mkdir()
    result = graded(tmp_path / "in", "4.1", launcher)
    assert result.score == 0
    assert all("no notebook of Exercise 4.1" in test.output for test in result.tests)


SORTED = "sorted(matcher.match(query_descriptors, train_descriptors), key=lambda m: m.distance)"
UNSORTED = "list(matcher.match(query_descriptors, train_descriptors))"
HOMOGRAPHY = "cv2.findHomography(points_mug, points_scene,"
BELIEVABLE = "return corners if cv2.isContourConvex(corners) and area > 400 else None"
# What is edited, which tests must lose by it, and what the student must read.
MISTAKES = {
    "swapped sizes": (
        [('images.load("ROS.png"), (400, 600)', 'images.load("ROS.png"), (600, 400)')],
        {"4.1.2", "4.1.9"},
        "width and height",
    ),
    "unsorted": ([(SORTED, UNSORTED)], {"4.1.4", "4.1.5"}, "not sorted"),
    "swapped match": (
        [
            (
                "match(query_descriptors, train_descriptors)",
                "match(train_descriptors, query_descriptors)",
            )
        ],
        {"4.1.4", "4.1.5", "4.1.6"},
        "query and train are swapped",
    ),
    "no look at the result": (
        [("if H is None or inlier_count < 10:", "if H is None:"), (BELIEVABLE, "return corners")],
        {"4.1.7"},
        "count the inliers",
    ),
    "inverse": (
        [(HOMOGRAPHY, "cv2.findHomography(points_scene, points_mug,")],
        {"4.1.5", "4.1.6"},
        "wrong way round",
    ),
    "globals": (
        [("= fit_homography(mug, scene, match_count)", "= fit_homography(*load_images(), 100)")],
        {"4.1.6", "4.1.7", "4.1.8"},
        "does it use its arguments",
    ),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named_and_costs_its_part(tmp_path, launcher, name):
    edits, loses, message = MISTAKES[name]
    result = graded(edited(NOTEBOOK, tmp_path, edits), "4.1", launcher)
    assert loses <= lost(result)
    assert result.score > 1.5
    assert any(message in test.output.lower() for test in result.tests), [
        test.output for test in result.tests
    ]
    assert any(picture.caption == "tilt" for picture in result.scenes)
