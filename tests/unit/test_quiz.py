"""Questions: what Python accepts, and what is stored for readers without a kernel."""

import base64

import cv2
import numpy as np
import pytest

from course_lib import quiz

QUESTION = {
    "question": "How many circle pixels does `FAST` look at?",
    "options": ["9", "16"],
    "answer": "16",
    "because": {"9": "That is the length of the arc.", "16": "A circle of radius 3 has 16."},
}


def test_text_names_question_and_options_but_not_the_answer() -> None:
    text = repr(quiz.choose(**QUESTION))
    assert text == "Question: How many circle pixels does `FAST` look at?\n  a) 9\n  b) 16"


def test_output_carries_a_still_of_the_question() -> None:
    for question in (quiz.choose(**QUESTION), quiz.number("How many?", 3)):
        data, metadata = question._repr_mimebundle_()
        still = base64.b64decode(data["image/png"])
        assert len(still) < 20_000
        picture = cv2.imdecode(np.frombuffer(still, np.uint8), cv2.IMREAD_GRAYSCALE)
        assert picture.min() < 80
        assert picture.max() > 240
        assert metadata["image/png"]["alt"] == data["text/plain"]
        assert "application/vnd.jupyter.widget-view+json" in data


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"answer": "12"}, "not one of the options"),
        ({"options": ["16"]}, "at least two different"),
        ({"options": ["16", "16"]}, "at least two different"),
        ({"because": {"16": "yes"}}, "why these options are wrong: \\['9'\\]"),
        ({"because": {"9": "no", "nine": "no"}}, "\\['nine'\\], which are not among"),
    ],
)
def test_questions_that_cannot_be_answered_are_refused(change: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        quiz.choose(**{**QUESTION, **change})


def test_numbers_must_be_finite_and_tolerances_positive() -> None:
    with pytest.raises(ValueError, match="finite"):
        quiz.number("?", float("nan"))
    with pytest.raises(ValueError, match="tolerance"):
        quiz.number("?", 1, tolerance=-1)
