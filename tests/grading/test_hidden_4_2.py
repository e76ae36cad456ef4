"""The hidden tests of Exercise 4.2: fair to what is right, clear about what is wrong."""

from __future__ import annotations

import nbformat
import pytest
from hidden_runs import by_number, edited, graded, lost
from independent_4_2 import CELLS, handed_in
from nbformat.v4 import new_code_cell, new_notebook

from course_lib.grading.sandbox import Launcher, Limits

NUMBERS = {f"4.2.{number}" for number in range(1, 10)}


@pytest.fixture(scope="module")
def launcher():
    with Launcher("bubblewrap", Limits()) as launcher:
        yield launcher


def changed(folder, edits):
    """Hand in the tutorial's way with parts of its files replaced; an empty new text removes."""
    handed_in("orb", folder)
    for file, old, new in edits:
        path = folder / file
        text = path.read_text()
        assert text.count(old) == 1, f"{old!r} is {text.count(old)} times in {file}"
        path.write_text(text.replace(old, new))
    return folder


def in_notebook(old, new):
    return "exercise_4_2.ipynb", *(text.replace('"', '\\"') for text in (old, new))


@pytest.mark.parametrize(("style", "seed"), [(style, b"a seed for %d" % i + b"." * 9)
                                             for i, style in enumerate(CELLS)])  # fmt: skip
def test_right_work_gets_every_point_whatever_its_method(tmp_path, launcher, style, seed):
    result = graded(handed_in(style, tmp_path / "in"), "4.2", launcher, seed)
    assert by_number(result).keys() == NUMBERS
    assert lost(result) == set(), [test for test in result.tests if test.score < test.max_score]
    assert result.max_score == 10
    assert result.events == ()


def test_the_solution_gets_every_point(tmp_path, launcher):
    result = graded(edited("exercise_4_2.ipynb", tmp_path / "in", ()), "4.2", launcher)
    assert lost(result) == set(), [test for test in result.tests if test.score < test.max_score]
    assert result.events == ()


def test_the_exercise_as_it_is_given_is_not_yet(tmp_path, launcher):
    given = edited("exercise_4_2.ipynb", tmp_path / "in", (), "exercises")
    result = graded(given, "4.2", launcher)
    assert result.score == 0, [test for test in result.tests if test.score]
    asked = [test for test in result.tests if test.number != "4.2.6"]
    assert all("not done yet" in test.output for test in asked), [t.output for t in asked]


def test_half_of_the_points_are_for_the_package(tmp_path, launcher):
    (tmp_path / "in").mkdir()
    result = graded(tmp_path / "in", "4.2", launcher)
    assert result.score == 0
    assert all("no notebook of Exercise 4.2" in test.output for test in result.tests)
    assert sum(test.max_score for test in result.tests if test.number >= "4.2.7") == 5


STUB = """def {name}(*arguments):
    raise NotImplementedError("yours to write")"""
FUNCTIONS = ("crop_waterhole", "locate_waterhole", "best_match_count")


def test_what_is_not_begun_is_not_yet(tmp_path, launcher):
    """Stubs as `course release` leaves them."""
    folder = handed_in("orb", tmp_path / "in")
    cells = [new_code_cell("import cv2")]
    cells += [new_code_cell(STUB.format(name=name)) for name in FUNCTIONS]
    nbformat.write(new_notebook(cells=cells), folder / "exercise_4_2.ipynb")
    stub = "<{tag}><!-- Your part: write it --></{tag}>"
    (folder / "unit4/package.xml").write_text(stub.format(tag="package"))
    (folder / "unit4/CMakeLists.txt").write_text("project(unit4)\n# Your part: the rest\n")
    for number in (1, 2):
        node = f"unit4/src/exercise4_2_{number}.py"
        (folder / node).write_text(
            "#!/usr/bin/env python3\nimport rospy\nrospy.init_node('a')\n"
            'raise NotImplementedError("wait for a message")\n'
        )
        launch = folder / f"unit4/launch/exercise4_2_{number}.launch"
        launch.write_text(stub.format(tag="launch"))
    result = graded(folder, "4.2", launcher)
    assert result.score == 0
    assert not any(test.status == "not_checked" for test in result.tests)
    asked = [test for test in result.tests if test.number != "4.2.6"]
    assert all("not done yet" in test.output for test in asked), [t.output for t in asked]


# What is edited, which tests must lose by it and no others, and what the student must read.
MISTAKES = {
    "swapped crop": (
        [in_notebook("frame[120:378, 198:434]", "frame[198:434, 120:378]")],
        {"4.2.2"},
        "x and y are swapped in the crop",
        {"4.2.3", "4.2.6", "4.2.8"},
    ),
    "whole frame": (
        [in_notebook("frame[120:378, 198:434].copy()", "frame.copy()")],
        {"4.2.2"},
        "cut closer",
        {"4.2.3", "4.2.7", "4.2.8"},
    ),
    "no look at the result": (
        [
            in_notebook("M is None or mask.sum() < 10", "M is None"),
            in_notebook("if not cv2.isContourConvex(dst)", "if False"),
        ],
        {"4.2.4", "4.2.5"},
        "count the inliers",
        {"4.2.1", "4.2.2", "4.2.7", "4.2.8", "4.2.9"},
    ),
    "inverse": (
        [in_notebook("cv2.findHomography(src, dst,", "cv2.findHomography(dst, src,")],
        {"4.2.3"},
        "wrong way round",
        {"4.2.2", "4.2.7", "4.2.8", "4.2.9"},
    ),
    "first candidate": (
        [in_notebook("if found > best_found", "if best is None")],
        {"4.2.5"},
        "says nothing",
        NUMBERS - {"4.2.5"},
    ),
    "no plot": (
        [
            in_notebook(
                'plt.plot(counts, found); plt.xlabel("matches"); plt.ylabel("frames")', "pass"
            )
        ],
        {"4.2.6"},
        "as a plot",
        NUMBERS - {"4.2.6"},
    ),
    "package": (
        [
            ("unit4/launch/exercise4_2_2.launch", "exercise4_2_2.py", "exercise4_2.py"),
            ("unit4/package.xml", "<exec_depend>rospy</exec_depend>", ""),
        ],
        {"4.2.7"},
        "<exec_depend>rospy</exec_depend>",
        NUMBERS - {"4.2.7"},
    ),
    "other topic": (
        [("unit4/src/exercise4_2_2.py", '"/waterhole/corners"', '"/corners"')],
        {"4.2.9"},
        "published nothing on /waterhole/corners, but on /corners",
        NUMBERS - {"4.2.9"},
    ),
    "crash without a homography": (
        [("unit4/src/exercise4_2_2.py", "M is not None and mask.sum() >= 10", "mask.sum() > 200")],
        {"4.2.9"},
        "returned none",
        NUMBERS - {"4.2.9"},
    ),
    "picture not saved": (
        [("unit4/src/exercise4_2_1.py", "cv2.imwrite(FILE,", "print(FILE,")],
        {"4.2.8"},
        "saved no picture",
        NUMBERS - {"4.2.8"},
    ),
    "picture with swapped colours": (
        [("unit4/src/exercise4_2_1.py", 'desired_encoding="bgr8"', 'desired_encoding="rgb8"')],
        {"4.2.8"},
        "red and blue",
        NUMBERS - {"4.2.8"},
    ),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named_and_costs_its_part(tmp_path, launcher, name):
    edits, loses, message, keeps = MISTAKES[name]
    result = graded(changed(tmp_path / "in", edits), "4.2", launcher)
    assert loses <= lost(result)
    assert not keeps & lost(result), [t for t in result.tests if t.number in keeps & lost(result)]
    assert any(message in test.output.lower() for test in result.tests), [
        test.output for test in result.tests
    ]
