"""A student's work as the checks see it: functions that may be missing, unfinished or wrong."""

from __future__ import annotations

import linecache
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from course_lib.checks.table import Row, Table, Verdict

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from types import TracebackType

_LONGEST = 300


class NotYetError(Exception):
    """A part of the work is not written; the message says which."""


class WrongError(Exception):
    """A part of the work is not right; the message says what to do about it."""


@dataclass(frozen=True)
class Check:
    """
    One question about the work.

    Attributes
    ----------
    function : str
        The function, or the file, that it is about.
    asks : str
        What that should do, for the student.
    ask : callable
        Takes the `Work`; raises `NotYetError` or `WrongError`.
    """

    function: str
    asks: str
    ask: Callable[[Work], None]


class Work:
    """
    The names that a notebook has defined.

    Parameters
    ----------
    namespace : mapping of str to object
    """

    def __init__(self, namespace: Mapping[str, Any]) -> None:
        self._namespace = namespace

    def call(self, name: str, *arguments: object) -> Any:  # noqa: ANN401
        """
        Call a function of the student's with copies of the arguments.

        Raises
        ------
        NotYetError
            There is no such function, or it raises NotImplementedError.
        WrongError
            It raises anything else, or changes a picture that it was given.
        """
        function = self._namespace.get(name)
        if function is None:
            raise NotYetError(f"There is no function {name} yet. Has its cell been run?")
        if not callable(function):
            raise WrongError(f"{name} is not a function any more. Give the variable another name.")
        given = [a.copy() if isinstance(a, np.ndarray) else a for a in arguments]
        try:
            result = function(*given)
        except NotImplementedError as error:
            hint = _sentence(str(error)) or "This part is yours to write."
            raise NotYetError(hint) from None
        except (Exception, SystemExit) as error:  # noqa: BLE001 (whatever a student's code raises)
            raise WrongError(_raised(name, error)) from None
        for before, after in zip(arguments, given, strict=True):
            if isinstance(before, np.ndarray) and not np.array_equal(before, np.asarray(after)):
                raise WrongError(
                    f"{name} draws into the picture that it is given, and so changes it for "
                    "everybody else. Work on image.copy()."
                )
        return result


def run(exercise: str, checks: Sequence[Check], work: Work) -> Table:
    """Ask every question and return the answers."""
    return Table(exercise, tuple(_answer(check, work) for check in checks))


def _answer(check: Check, work: Work) -> Row:
    try:
        check.ask(work)
    except NotYetError as error:
        return Row(check.function, check.asks, Verdict.NOT_YET, str(error))
    except WrongError as error:
        return Row(check.function, check.asks, Verdict.WRONG, str(error))
    return Row(check.function, check.asks, Verdict.RIGHT)


def _sentence(text: str) -> str:
    text = " ".join(text.split())[:_LONGEST]
    return text[:1].upper() + text[1:].rstrip(".") + "." if text else ""


def _raised(name: str, error: BaseException) -> str:
    """Describe an exception with the student's own line in which it happened."""
    message = " ".join(str(error).split())[:_LONGEST]
    kind = type(error).__name__
    said = f"{name} raised {kind}: {message}" if message else f"{name} raised {kind}"
    line = _own_line(error.__traceback__)
    return f"{said} (in your line: {line})" if line else said


def _own_line(trace: TracebackType | None) -> str:
    library = Path(__file__).resolve().parents[1]
    found = ""
    for frame, number in traceback.walk_tb(trace):
        path = frame.f_code.co_filename
        if "site-packages" in path or Path(path).is_relative_to(library):
            continue
        found = linecache.getline(path, number, frame.f_globals).strip() or found
    return found[:_LONGEST]
