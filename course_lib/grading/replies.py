"""What a student's process answered: a value, or an error in the student's own terms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_lib.grading import wire
from course_lib.grading.error_hints import hint
from course_lib.grading.text import clean

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


class StudentError(Exception):
    """What kept a student's function from giving a result, worded for the student."""


class NotSubmittedError(StudentError):
    """There is no notebook of this exercise."""


class Missing(StudentError):  # noqa: N818  (a rubric reads better so)
    """The notebook defines no such function."""


class NotDone(StudentError):  # noqa: N818
    """The function raises NotImplementedError."""


class Raised(StudentError):  # noqa: N818
    """The function raised an exception.

    Attributes
    ----------
    on_purpose : bool
        Whether the student's own line raises it.
    """

    def __init__(self, message: str, *, on_purpose: bool = False) -> None:
        super().__init__(message)
        self.on_purpose = on_purpose


class TimedOut(StudentError):  # noqa: N818
    """The function took too long."""


class Died(StudentError):  # noqa: N818
    """The process died, or was ended for breaking a limit."""


class BadValue(StudentError):  # noqa: N818
    """The returned value cannot be read: too large, too deep, or malformed."""


def outcome(what: str, content: Mapping[str, Any], buffers: Sequence[bytes]) -> Any:  # noqa: ANN401
    """Read what an agent answered.

    Parameters
    ----------
    what : str
        What was asked for, as the student knows it.
    content : mapping
    buffers : sequence of bytes

    Returns
    -------
    object
        As `wire.decode` gives it.

    Raises
    ------
    StudentError
        One of its kinds.
    """
    status = content.get("status")
    if status == "ok":
        try:
            return wire.decode(content.get("value"), buffers)
        except wire.BadDataError as error:
            raise BadValue(f"What {what} returned could not be read: {error}.") from error
    if status == "bad":
        raise BadValue(f"What {what} returned could not be read: {_text(content, 'message')}.")
    if status != "error":
        raise TimedOut(f"{what} was interrupted.")
    kind, message = _text(content, "type"), _text(content, "message")
    kinds = content.get("kinds")
    kinds = kinds if isinstance(kinds, list) else []
    if kind == "_MissingError":
        raise Missing(
            f"Your notebook has no function {what}: was its cell deleted, or its name changed?"
        )
    if "NotImplementedError" in kinds:
        raise NotDone(f"{what} is not done yet (it raises NotImplementedError).")
    line = _text(content, "line", 300)
    where = f" in the line `{line}`" if line else ""
    said = f"{what} raised {kind}: {message}{where}" if message else f"{what} raised {kind}{where}"
    raise Raised(f"{said.rstrip('.')}.{hint(kind, message)}", on_purpose=line.startswith("raise "))


def _text(content: Mapping[str, Any], name: str, limit: int = 2000) -> str:
    """Give a text of a reply; a stranger may put anything there, too deep even to be shown."""
    found = content.get(name)
    return clean(found, limit).strip() if isinstance(found, str) else ""
