"""What a student's process answers may be anything: it costs the student, not the grading."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from course_lib.grading import wire
from course_lib.grading.plots import shows_plot
from course_lib.grading.replies import BadValue, Raised
from course_lib.grading.rubric import Grade, GradeFailed
from course_lib.grading.seeds import Seeds
from course_lib.grading.student import Student

HIDDEN = Path(__file__).parents[1] / "hidden"
NODE = "src/exercise4_2_2.py"
LAUNCH = (
    '<launch><node pkg="unit4" type="exercise4_2_2.py" name="a"><param name="n" value="1"/></node>'
    "</launch>"
)


@pytest.fixture(autouse=True)
def _points(request):
    """Let hidden tests be imported, which are marked with their points."""
    request.config.addinivalue_line("markers", "points: what a hidden test is worth")


class Answers:
    """Stands for a notebook and its channel, and answers from a table."""

    def __init__(self, **answers: object) -> None:
        self.cells, self.pictures = [], []
        self._answers = answers
        self._asked = ""

    def channel(self) -> Answers:
        return self

    def seconds_left(self) -> float:
        return 100.0

    def send(self, _kind: str, content: dict, buffers: list[bytes]) -> str:
        arguments = wire.decode(content["arguments"], buffers)
        self._asked = arguments.get("function", content["operation"])
        return "request"

    def reply(self, *_: object) -> dict:
        answer = self._answers.get(self._asked)
        if isinstance(answer, dict) and "status" in answer:
            return {"content": answer}
        tree, buffers = wire.encode(answer)
        return {"content": {"status": "ok", "value": json.loads(json.dumps(tree))}} | {
            "buffers": buffers
        }


def hidden(name: str):
    spec = importlib.util.spec_from_file_location(f"odd_{name}", HIDDEN / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def nested(depth: int) -> dict:
    found: dict = {}
    for _ in range(depth):
        found = {"a": found}
    return found


@pytest.mark.parametrize("part", ["type", "message", "line"])
def test_an_error_nested_too_deep_to_be_shown_is_an_error(part):
    answer = {"status": "error", "type": "ValueError", "message": "no"} | {part: nested(3000)}
    with pytest.raises(Raised, match="locate_mug raised"):
        Student(Answers(locate_mug=answer), 1).locate_mug()


def test_a_complaint_nested_too_deep_to_be_shown_is_one():
    answer = {"status": "bad", "message": nested(3000)}
    with pytest.raises(BadValue, match="could not be read"):
        Student(Answers(locate_mug=answer), 1).locate_mug()


def test_parameters_that_cannot_be_sent_are_the_launch_files_fault():
    deep: list = []
    for _ in range(20):
        deep = [deep]
    with pytest.raises(BadValue, match="cannot be sent"):
        Student(Answers(), 1).run_node(NODE, [], params={"a": deep})


def test_an_array_is_no_run_of_a_node():
    with pytest.raises(BadValue, match="could not be read"):
        Student(Answers(run_node=np.zeros(3)), 1).run_node(NODE, [])


def test_thousands_of_saved_pictures_are_not_all_looked_at():
    run = {"topics": {}, "counts": {}, "types": {}, "unstamped": [], "error": None, "log": ""}
    answers = Answers(run_node=run | {"files": {f"{n}.png": b"" for n in range(1500)}})
    assert len(Student(answers, 1).run_node(NODE, []).files) < 10


@pytest.mark.parametrize("count", [np.array([60, 4]), [60], float("inf"), float("nan"), "60", True])
def test_what_is_no_whole_number_is_no_match_count(count):
    answers = Answers(
        crop_waterhole=np.zeros((100, 120, 3), np.uint8),
        best_match_count=count,
    )
    grade = Grade()
    with pytest.raises(GradeFailed, match="should return a whole number"):
        hidden("test_4_2_parts").test_best_match_count(
            Student(answers, 20), grade, Seeds(b"a seed of these tests")
        )


def test_corners_of_no_shape_are_no_corners():
    run = {"counts": {}, "types": {}, "unstamped": [], "files": {}, "error": None, "log": ""}
    files = {
        NODE: (b"import rospy\n", True),
        "launch/exercise4_2_2.launch": (LAUNCH.encode(), True),
    }
    answers = Answers(
        crop_waterhole=np.zeros((100, 120, 3), np.uint8),
        files=files,
        run_node=run | {"topics": {"/waterhole/corners": [(1, [[1], [1, 2]])]}},
    )
    with pytest.raises(GradeFailed, match="published nothing"):
        hidden("test_4_2_package").test_second_node(
            Student(answers, 20), Grade(), Seeds(b"a seed of these tests")
        )


@pytest.mark.parametrize("shape", [(1, 5000, 3), (5000, 1, 3), (1, 1, 3)])
def test_a_strip_is_no_plot(shape):
    assert not shows_plot(np.full(shape, 90, np.uint8))
