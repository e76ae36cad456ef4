"""
What a hidden test is written with: points, partial credit, messages, pictures.

A hidden test is an ordinary pytest function that asks for the fixtures `student` (the student's
functions, see `course_lib.grading.student`), `grade` (below) and `seeds` (numbers from the
instructor's secret)::

    @points(2, "4.1.6", "Finds the mug in pictures you have not seen")
    def test_unseen(student, grade, seeds):
        scene = mug_scene(seeds("unseen"))
        with grade.attempt():
            corners = student.locate_mug(scene.mug, scene.scene)
            grade.add(credit(corners, scene.corners), message="…")
"""

from __future__ import annotations

from collections import Counter
from contextlib import contextmanager
from typing import TYPE_CHECKING

import cv2
import pytest

from course_lib.grading.replies import StudentError
from course_lib.grading.results import Picture

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from numpy.typing import NDArray

_MOST_MESSAGES = 6
_WIDEST_PICTURE = 640  # px; an instructor's page holds many


class GradeFailed(Exception):  # noqa: N818  (not an error of the test)
    """Ends a test whose points are lost."""


def points(value: float, number: str, title: str) -> pytest.MarkDecorator:
    """Say what a test is worth.

    Parameters
    ----------
    value : float
        Points.
    number : str
        Its place in the rubric, such as ``"4.1.6"``.
    title : str
        What it asks, in a student's words.

    Returns
    -------
    pytest.MarkDecorator
    """
    return pytest.mark.points(value, number, title)


class Grade:
    """Collects what one test gives: credit, messages, pictures for the instructor.

    A test that ends without having given or lost any credit gives all of it.
    """

    def __init__(self) -> None:
        self._reached = 0.0
        self._possible = 0.0
        self._messages: Counter[str] = Counter()
        self._scenes: list[Picture] = []

    @property
    def fraction(self) -> float:
        """The part of the points that was reached, from 0 to 1."""
        if not self._possible:
            return 1.0
        return min(1.0, max(0.0, self._reached / self._possible))

    @property
    def messages(self) -> list[str]:
        """What the student reads, each once, the most frequent first."""
        return [
            text if times == 1 else f"{text} ({times} times)"
            for text, times in self._messages.most_common(_MOST_MESSAGES)
        ]

    @property
    def scenes(self) -> tuple[Picture, ...]:
        """The pictures for the instructor."""
        return tuple(self._scenes)

    def add(self, fraction: float, *, out_of: float = 1.0, message: str | None = None) -> None:
        """Give part of the credit for a part of the test.

        Parameters
        ----------
        fraction : float
            How good it is, from 0 to 1. NaN counts as 0.
        out_of : float, optional
            The weight of this part.
        message : str, optional
            What to tell the student; without the hidden input's numbers.
        """
        self._possible += out_of
        if fraction == fraction:  # noqa: PLR0124  (false for NaN alone)
            self._reached += out_of * min(1.0, max(0.0, fraction))
        if message:
            self.note(message)

    def note(self, message: str) -> None:
        """Tell the student something that costs nothing."""
        self._messages[message] += 1

    def fail(self, message: str) -> None:
        """End the test without points.

        Raises
        ------
        GradeFailed
            Always.
        """
        self.lose(message)
        raise GradeFailed(message)

    def lose(self, message: str) -> None:
        """Take the whole test's credit away."""
        self._reached, self._possible = 0.0, 1.0
        self.note(message)

    def check(self, condition: object, message: str) -> None:
        """End the test without points unless a condition holds."""
        if not condition:
            self.fail(message)

    @contextmanager
    def attempt(self, *, out_of: float = 1.0) -> Iterator[None]:
        """Let what goes wrong in the student's code cost this part only.

        Parameters
        ----------
        out_of : float, optional
            The weight of the part.
        """
        try:
            yield
        except StudentError as error:
            self.add(0.0, out_of=out_of, message=str(error))

    def scene(self, caption: str, picture: NDArray[np.uint8]) -> None:
        """Keep a picture for the instructor alone.

        Parameters
        ----------
        caption : str
            What it shows.
        picture : ndarray
            BGR uint8.
        """
        scale = min(1.0, _WIDEST_PICTURE / picture.shape[1])
        small = cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        ok, png = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, 80])
        if ok:
            self._scenes.append(Picture(caption, png.tobytes()))
