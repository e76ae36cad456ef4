"""Writes what people read: a page for each student, one for the instructor, one for the class.

Whatever comes from a submission is cleaned (`text.clean`), escaped by the templates, and shown on
pages that may run no script and fetch nothing (their Content-Security-Policy says so).
"""

from __future__ import annotations

import base64
import hashlib
import io
import struct
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

from course_lib.grading import atomic, exports
from course_lib.grading.class_page import gather
from course_lib.grading.summary import (
    INSTRUCTOR,
    RESULTS,
    Summary,
    checked,
    exercise_of,
    line,
    points,
    read_summary,
    said,
    student_folder,
    tidy,
    to_json,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from jinja2 import Environment

    from course_lib.grading.results import Picture, SubmissionResult, TestResult

__all__ = ["Summary", "read_summary", "student_folder", "write_class", "write_student"]

REPORT = "report.html"
_TEMPLATES = Path(__file__).parent / "templates"
_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8\xff"
_MOST_PICTURES = 40
_MOST_BYTES = 24 * 1024**2


@dataclass(frozen=True)
class Shown:
    """A picture as the page needs it."""

    caption: str
    source: str
    width: int
    height: int


@dataclass(frozen=True)
class Advice:
    """One message, and every test that it explains."""

    output: str
    tests: tuple[TestResult, ...]

    @property
    def lost(self) -> float:
        """Points that this cost."""
        return sum(test.max_score - test.score for test in self.tests)


def prepare() -> None:
    """Read the pages' templates, which takes a tenth of a second, before there is a result."""
    environment = _environment()
    for template in environment.list_templates(extensions=["j2"]):
        environment.get_template(template)


def write_student(
    result: SubmissionResult,
    folder: Path,
    *,
    code_fingerprint: Mapping[str, frozenset[int]] | None = None,
) -> None:
    """Write a student's results: results.json and report.html, and a page for the instructor.

    Parameters
    ----------
    result : SubmissionResult
    folder : Path
        ``student_folder(out, result.student)``; it may be handed to the student as it is. The
        instructor's page, with the held-out scenes, goes to ``out/_instructor`` instead.
    code_fingerprint : mapping of str to frozenset of int, optional
        What `similarity.own` made of ``result.code``; by default all of it.

    Notes
    -----
    results.json is written last: where it stands, everything stands.
    """
    if folder.name.casefold() == INSTRUCTOR:
        raise ValueError("use student_folder: this name is kept for the instructor's pages")
    result = tidy(result)
    view = _view(result)
    student = _render("student.html.j2", view, pictures=_shown(result.pictures, "Picture"))
    atomic.write(folder / REPORT, student)
    instructor = _render(
        "instructor.html.j2",
        view,
        scenes=_shown(result.scenes, "Held-out scene"),
        events=[line(event, 2000) for event in result.events],
        report=f"../../{_quoted(folder.name)}/{REPORT}",
        index="../../index.html",
    )
    atomic.write(folder.parent / INSTRUCTOR / folder.name / REPORT, instructor)
    code = result.code if code_fingerprint is None else code_fingerprint
    atomic.write(folder / RESULTS, to_json(result, code))


def write_class(out: Path) -> None:
    """Write index.html, grades.csv, grades.json and moodle.csv from the students' results.json.

    Parameters
    ----------
    out : Path
        The folder with a folder for each student. They are read one at a time, so this works as
        well for a run that was resumed.
    """
    page = _render(
        "class.html.j2",
        {"page": gather(out)},
        report=REPORT,
        instructor=INSTRUCTOR,
        script=(_TEMPLATES / "class.js").read_text("utf-8"),
    )
    for name in ("csv", "json", "moodle"):
        exports.write(out, name)
    atomic.write(out / "index.html", page)


def _view(result: SubmissionResult) -> dict[str, object]:
    shown = [test for test in result.tests if test.visibility != "hidden"]
    by_exercise: dict[str, list[TestResult]] = {}
    for test in result.tests:
        by_exercise.setdefault(exercise_of(test.number), []).append(test)
    sections = {
        "What to mend": _advice(test for test in shown if test.status in {"partial", "failed"}),
        "What could not be checked": _advice(t for t in shown if t.status == "not_checked"),
    }
    costliest = sorted(
        sections.items(), key=lambda item: -max((a.lost for a in item[1]), default=0)
    )
    return {
        "student": line(result.student, 120) or "A submission without a name",
        "score": result.score,
        "max_score": result.max_score,
        "status": checked(result.tests),
        "exercises": by_exercise,
        "tests": result.tests,
        "shown": shown,
        "sections": [(title, advice) for title, advice in costliest if advice],
        "right": [test for test in shown if test.status == "passed"],
        "notes": [line(note, 2000) for note in result.notes],
        "seconds": result.seconds,
        "fingerprint": line(result.fingerprint, 16),
    }


def _advice(tests: Iterable[TestResult]) -> list[Advice]:
    """Gather tests under the message that explains them, the costliest first."""
    found: dict[str, list[TestResult]] = {}
    for test in tests:
        # Tests that say nothing have nothing in common.
        found.setdefault(said(test.output) or f"\0{test.number}", []).append(test)
    advice = [
        Advice("" if output.startswith("\0") else output, tuple(about))
        for output, about in found.items()
    ]
    return sorted(advice, key=lambda one: -one.lost)


def _shown(pictures: Sequence[Picture], kind: str) -> list[Shown]:
    shown, room = [], _MOST_BYTES
    for index, picture in enumerate(pictures[:_MOST_PICTURES], start=1):
        room -= len(picture.png)
        if room < 0:
            break
        if (kind_and_size := _kind_and_size(picture.png)) is None:
            continue
        what, width, height = kind_and_size
        source = f"data:image/{what};base64," + base64.b64encode(picture.png).decode()
        shown.append(Shown(line(picture.caption) or f"{kind} {index}", source, width, height))
    return shown


def _kind_and_size(data: bytes) -> tuple[str, int, int] | None:
    """Tell what the grader has encoded: PNG, or JPEG for the many held-out scenes."""
    if data.startswith(_PNG) and len(data) >= 24:
        width, height = struct.unpack(">II", data[16:24])
        return "png", width, height
    if data.startswith(_JPEG):
        from PIL import Image, UnidentifiedImageError  # noqa: PLC0415

        with (
            suppress(OSError, ValueError, UnidentifiedImageError),
            Image.open(io.BytesIO(data), formats=("JPEG",)) as picture,
        ):
            return "jpeg", *picture.size
    return None


def _quoted(name: str) -> str:
    # Never a scheme: javascript: would be one.
    return quote(name, safe="", errors="surrogateescape")


@lru_cache(maxsize=1)
def _environment() -> Environment:
    # Imported late, so that a worker that only runs notebooks does without.
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # noqa: PLC0415
    from markupsafe import Markup  # noqa: PLC0415

    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "points": points,
        "line": line,
        "said": said,
        "quoted": _quoted,
        "hash": _csp_hash,
        "trusted": Markup,
    }
    return environment


def _render(template: str, view: Mapping[str, object], **more: object) -> bytes:
    page = _environment().get_template(template).render(**view, **more)
    # A name may hold what no text can, half a character: shown as a question mark.
    return page.encode("utf-8", errors="replace")


def _csp_hash(script: str) -> str:
    """Return what lets this script, and no other, run."""
    digest = hashlib.sha256(script.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
