"""A submission's answers about pictures, each asked for once however many tests want it."""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from course_lib.grading.replies import StudentError

if TYPE_CHECKING:
    from collections.abc import Hashable

    from numpy.typing import NDArray

    from course_lib._validate import Image
    from course_lib.grading.student import Student

    Key = tuple[Hashable, ...]

# Scenes made from a seed are shared and stay, so a picture's identity stands for the picture; what
# was asked is kept beside the answer, so that no other picture gets its identity.
_KEPT: WeakKeyDictionary[Student, dict[Key, tuple[tuple[object, ...], object]]] = (
    WeakKeyDictionary()
)


class Answers:
    """Asks one submission where the mug or the waterhole is.

    Parameters
    ----------
    student : Student
        The submission's proxy.
    """

    def __init__(self, student: Student) -> None:
        self._student = student
        self._kept = _KEPT.setdefault(student, {})
        self._given: list[object] = []

    def locate_mug(self, mug: Image, scene: Image) -> object:
        """Return what the submission returns, or raise what it raised, asking once.

        Parameters
        ----------
        mug, scene : ndarray of uint8
            BGR.

        Raises
        ------
        StudentError
            What went wrong in the submission.
        """
        answer = self.ask("locate_mug", mug, scene)
        self._given.append(answer)
        return answer

    def locate_waterhole(self, template: Image, frame: Image, match_count: int) -> object:
        """Return what the submission returns, or raise what it raised, asking once.

        Parameters
        ----------
        template, frame : ndarray of uint8
            BGR.
        match_count : int

        Raises
        ------
        StudentError
            What went wrong in the submission.
        """
        answer = self.ask("locate_waterhole", template, frame, match_count)
        self._given.append(answer)
        return answer

    def ask(self, function: str, *arguments: object) -> object:
        """Call one of the submission's functions, or give what it gave for the same arguments.

        Parameters
        ----------
        function : str
            Its name.
        *arguments : ndarray, int
            The same picture means the same object.

        Raises
        ------
        StudentError
            What went wrong in the submission.
        """
        key = (function, *(each if isinstance(each, int) else id(each) for each in arguments))
        if key not in self._kept:
            answer: object
            try:
                answer = self._student.call(function, *arguments)
            except StudentError as error:
                answer = error
            self._kept[key] = (arguments, answer)
        answer = self._kept[key][1]
        if isinstance(answer, StudentError):
            raise answer
        return answer

    def quietly(self, mug: Image, scene: Image) -> object:
        """Return what the submission returns, and None for an error."""
        try:
            return self.locate_mug(mug, scene)
        except StudentError:
            return None

    def all_the_same(self) -> bool:
        """Tell whether one outline was given for every picture of several."""
        arrays: list[NDArray[np.generic]] = [
            answer for answer in self._given if isinstance(answer, np.ndarray)
        ]
        if len(arrays) < 3 or len(arrays) < len(self._given):
            return False
        return all(np.array_equal(arrays[0], other) for other in arrays[1:])
