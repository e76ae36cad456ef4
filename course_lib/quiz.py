"""Questions with feedback at once, answered in the browser: no kernel, no points, no record."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anywidget
from traitlets import Dict, List, Unicode

from course_lib.display import encode_png
from course_lib.explore._base import mimebundle
from course_lib.explore._still import text_page

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_HERE = Path(__file__).parent


class Question(anywidget.AnyWidget):
    """A question whose answer the browser judges.

    Attributes
    ----------
    kind
        `choose` or `number`.
    question, options
        What is asked; text between backquotes is set as code.
    key
        What the browser needs to judge an answer.
    given
        The student's last answer, kept so that it survives scrolling and reopening a view.
    """

    _esm = (_HERE / "quiz.js").read_text(encoding="utf-8")
    _css = (_HERE / "quiz.css").read_text(encoding="utf-8")

    kind = Unicode().tag(sync=True)
    question = Unicode().tag(sync=True)
    options = List(Unicode()).tag(sync=True)
    key = Dict().tag(sync=True)
    given = Unicode().tag(sync=True)

    def __repr__(self) -> str:
        letters = (f"  {chr(ord('a') + i)}) {option}" for i, option in enumerate(self.options))
        return "\n".join([f"Question: {self.question}", *letters])

    def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:  # noqa: ANN401
        text = repr(self)
        still = encode_png(text_page(text.replace("`", ""), 640))
        return mimebundle(super()._repr_mimebundle_(**kwargs), still, text)


def choose(
    question: str,
    options: Sequence[str],
    answer: str,
    because: Mapping[str, str],
) -> Question:
    """Ask for one of several options; every choice is answered with its reason.

    Parameters
    ----------
    question
        The question; text between backquotes is set as code.
    options
        At least two different answers to choose from.
    answer
        The right one, word for word as in `options`.
    because
        For every wrong option the reason why it is wrong, and, as a rule, for the right one why
        it is right.

    Returns
    -------
    Question
        A widget; end a cell with it.

    Raises
    ------
    ValueError
        When the answer is not among the options, an option appears twice, a wrong option has no
        reason, or a reason belongs to no option.

    Examples
    --------
    >>> choose(
    ...     "How many circle pixels does FAST look at?",
    ...     ["9", "16"],
    ...     answer="16",
    ...     because={"9": "That is the arc's length.", "16": "A circle of radius 3 has 16."},
    ... )
    Question: How many circle pixels does FAST look at?
      a) 9
      b) 16
    """
    options = list(options)
    if len(options) < 2 or len(set(options)) < len(options):
        raise ValueError(f"options must be at least two different answers, not {options}")
    if answer not in options:
        raise ValueError(f"answer {answer!r} is not one of the options {options}")
    if strange := [option for option in because if option not in options]:
        raise ValueError(f"because gives reasons for {strange}, which are not among the options")
    if silent := [option for option in options if option not in because and option != answer]:
        raise ValueError(f"because must say why these options are wrong: {silent}")
    reasons = [because.get(option, "") for option in options]
    key = {"answer": options.index(answer), "reasons": reasons}
    return Question(kind="choose", question=question, options=options, key=key)


def number(
    question: str,
    answer: float,
    *,
    tolerance: float = 0,
    unit: str = "",
    because: str | Mapping[float, str] = "",
) -> Question:
    """Ask for a number; a wrong one is answered with a reason, or with its direction.

    Parameters
    ----------
    question
        The question; text between backquotes is set as code.
    answer
        The right number.
    tolerance
        Numbers this close to the answer are right too.
    unit
        Unit shown behind the field; students may type it or leave it.
    because
        Why the answer is right; or a reason for each of several numbers: the right one and the
        mistakes to expect.

    Returns
    -------
    Question
        A widget; end a cell with it.

    Raises
    ------
    ValueError
        When the answer is not finite or the tolerance is negative.

    Examples
    --------
    >>> number("How many bytes do 256 bits take?", 32, unit="bytes", because="256 / 8 = 32")
    Question: How many bytes do 256 bits take?
    """
    if not math.isfinite(answer):
        raise ValueError(f"answer must be a finite number, not {answer}")
    if not tolerance >= 0:
        raise ValueError(f"tolerance must be 0 or more, not {tolerance}")
    reasons = {answer: because} if isinstance(because, str) else dict(because)
    key = {
        "answer": answer,
        "tolerance": tolerance,
        "unit": unit,
        "reasons": [[value, reason] for value, reason in reasons.items()],
    }
    return Question(kind="number", question=question, key=key)
