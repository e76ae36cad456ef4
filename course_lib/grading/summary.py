"""A student's results.json, in Gradescope's format: written from a result, read for the class."""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, cast, get_args

from course_lib.grading.results import Status, TestResult
from course_lib.grading.similarity import pack, unpack
from course_lib.grading.text import clean

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from course_lib.grading.results import SubmissionResult

RESULTS = "results.json"
INSTRUCTOR = "_instructor"
Checked = Literal["graded", "partly checked", "not checked"]
# Larger than any that we write.
_MOST_BYTES = 32 * 1024**2


@dataclass(frozen=True)
class Summary:
    """What results.json says of a submission.

    Attributes
    ----------
    student : str
        The submission's name, as it was; it must be cleaned before it is shown.
    folder : str
        The name of the folder with the student's results.
    score, max_score : float
    tests : tuple of TestResult
    status : str
        Whether every test could be run.
    notes, events : tuple of str
        As in `SubmissionResult`.
    fingerprint : str
        As in `SubmissionResult`; equal means nothing to grade anew.
    code : mapping of str to frozenset of int
        Exercise to what `similarity.of_submission` says.
    seconds : float
    """

    student: str
    folder: str
    score: float
    max_score: float
    tests: tuple[TestResult, ...]
    status: Checked
    notes: tuple[str, ...] = ()
    events: tuple[str, ...] = ()
    fingerprint: str = ""
    code: Mapping[str, frozenset[int]] = field(default_factory=dict, repr=False)
    seconds: float = 0.0


def student_folder(out: Path, student: str) -> Path:
    """Return the folder for a student's results; each student has another.

    Names that would hide our own files, be hidden, or not fit are written differently.

    Examples
    --------
    >>> from pathlib import Path
    >>> [student_folder(Path("out"), name).name for name in ("zoe", "_instructor", "index.html")]
    ['zoe', '%5Finstructor', '%69ndex.html']
    """
    ours = {"index.html", "grades.csv", "grades.json", "moodle.csv", "canvas.csv", "gradescope.zip"}
    name = student.replace("/", "%2F").replace("\0", "%00") or "%"
    if name[0] in "_.%~" or name.casefold() in ours:
        name = f"%{ord(name[0]):02X}{name[1:]}"
    raw = os.fsencode(name)
    if len(raw) > 200:
        # Cut where no character is halved.
        name = f"{raw[:150].decode(errors='ignore')}~{hashlib.sha256(raw).hexdigest()[:16]}"
    return out / name


def checked(tests: tuple[TestResult, ...]) -> Checked:
    """Say whether every test could be run."""
    missing = sum(test.status == "not_checked" for test in tests)
    if not missing and tests:
        return "graded"
    return "partly checked" if missing < len(tests) else "not checked"


def to_json(result: SubmissionResult, code: Mapping[str, frozenset[int]]) -> bytes:
    """Write a result in Gradescope's format.

    ASCII, so that whatever a name holds can be written; numbers are finite.
    """
    result = tidy(result)
    tests = [
        {
            "name": line(test.name),
            "number": line(test.number),
            "score": test.score,
            "max_score": test.max_score,
            "status": "passed" if test.status == "passed" else "failed",
            "output": said(test.output),
            "output_format": "text",
            "visibility": test.visibility,
            # Gradescope knows two words only.
            "extra_data": {"status": test.status, "seconds": number(test.seconds)},
        }
        for test in result.tests
    ]
    notes = [clean(note) for note in result.notes]
    content = {
        "score": number(result.score),
        "execution_time": round(result.seconds),
        "output": "\n".join(
            [f"{points(result.score)} of {points(result.max_score)} points", *notes]
        ),
        "output_format": "text",
        "visibility": "visible",
        "tests": tests,
        "extra_data": {
            "student": result.student,
            "status": checked(result.tests),
            "max_score": number(result.max_score),
            "seconds": result.seconds,
            "fingerprint": result.fingerprint,
            "notes": notes,
            "events": [clean(event) for event in result.events],
            "code": {exercise: pack(marks) for exercise, marks in sorted(code.items())},
        },
    }
    return json.dumps(content, indent=1, allow_nan=False).encode("ascii")


def read_summary(folder: Path) -> Summary:
    """Read a student's results.json.

    Raises
    ------
    FileNotFoundError
        There is none.
    ValueError
        It is damaged.
    """
    path = folder / RESULTS
    if path.stat().st_size > _MOST_BYTES:
        raise ValueError(f"{path} is no result of ours: it is too large")
    try:
        content = json.loads(path.read_bytes())
        extra = content["extra_data"]
        return Summary(
            student=str(extra["student"]),
            folder=folder.name,
            score=number(content["score"]),
            max_score=number(extra["max_score"]),
            tests=tuple(_test(test) for test in content["tests"]),
            status=extra["status"],
            notes=tuple(map(str, extra["notes"])),
            events=tuple(map(str, extra["events"])),
            fingerprint=str(extra["fingerprint"]),
            code={exercise: unpack(marks) for exercise, marks in extra["code"].items()},
            seconds=number(extra["seconds"]),
        )
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"{path} is damaged: {type(error).__name__}: {error}") from error


def summaries(out: Path) -> Iterator[Summary | Path]:
    """Read the students' results one after the other, by name; a damaged one gives its folder."""
    for folder in sorted(out.iterdir(), key=lambda path: (path.name.casefold(), path.name)):
        if folder.name == INSTRUCTOR or not (folder / RESULTS).is_file():
            continue
        try:
            yield read_summary(folder)
        except ValueError:
            yield folder


def graded(out: Path) -> Iterator[Summary]:
    """Read the students' results one after the other, by name, without the damaged ones."""
    return (found for found in summaries(out) if isinstance(found, Summary))


def _test(test: Any) -> TestResult:  # noqa: ANN401
    status = test["extra_data"]["status"]
    if status not in get_args(Status):
        raise ValueError(f"unknown status {status!r}")
    return TestResult(
        name=str(test["name"]),
        number=str(test["number"]),
        score=number(test["score"]),
        max_score=number(test["max_score"]),
        output=str(test["output"]),
        status=cast("Status", status),
        visibility=str(test["visibility"]),
        seconds=number(test["extra_data"]["seconds"]),
    )


def number(value: float) -> float:
    """Return a finite number, rounded so that sums stay readable."""
    value = float(value)
    return round(value, 4) if math.isfinite(value) else 0.0


def points(value: float) -> str:
    """Write points for people: at most two decimals, never more than there are.

    Examples
    --------
    >>> points(2.0), points(1.5), points(1.999), points(0.1 + 0.2)
    ('2', '1.5', '1.99', '0.3')
    """
    shown = math.floor(number(value) * 100 + 1e-6) / 100
    return f"{shown:.2f}".rstrip("0").rstrip(".")


def tidy(result: SubmissionResult) -> SubmissionResult:
    """Return a result with its tests in order and no points that are nonsense, so no sum is."""
    tests = (
        replace(test, score=number(test.score), max_score=number(test.max_score))
        for test in sorted(result.tests, key=lambda test: in_order(test.number))
    )
    return replace(result, tests=tuple(tests), seconds=number(result.seconds))


def said(text: str, limit: int = 4000) -> str:
    """Clean a message; a flood of empty lines becomes one."""
    return re.sub(r"\n\s*\n", "\n\n", clean(text, limit)).strip()


def line(text: str, limit: int = 300) -> str:
    """Clean a text for a place that holds one line."""
    return " ".join(clean(text, limit).split())


def exercise_of(test_number: str) -> str:
    """Return the exercise of a test.

    Examples
    --------
    >>> exercise_of("4.1.3")
    '4.1'
    """
    return ".".join(test_number.split(".")[:2])


def in_order(test_number: str) -> tuple[tuple[int, str], ...]:
    """Return a key that sorts 4.1.9 before 4.1.10."""
    parts = test_number.split(".")
    return tuple((int(part), "") if part.isdecimal() else (10**6, part) for part in parts)
