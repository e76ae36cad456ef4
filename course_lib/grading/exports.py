"""Writes grades for spreadsheets, Canvas, Moodle, Gradescope and programs."""

from __future__ import annotations

import csv
import html
import io
import json
import os
import re
import sys
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.grading import atomic
from course_lib.grading import roster as rosters
from course_lib.grading.summary import RESULTS, Summary, graded, in_order, line, points

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterable, Sequence

ASSIGNMENT = "Feature matching"
UNMATCHED = "unmatched.txt"
FILES = {
    "csv": "grades.csv",
    "canvas": "canvas.csv",
    "moodle": "moodle.csv",
    "json": "grades.json",
    "gradescope": "gradescope.zip",
}
# A spreadsheet takes a cell that begins like this for a formula; the wide forms too.
_FORMULA = tuple("=+-@\t\r\n＝＋－＠")


def write(
    out: Path,
    format: str,  # noqa: A002
    roster: Path | None = None,
    *,
    assignment: str = ASSIGNMENT,
) -> Path:
    """Write the grades of a class.

    Parameters
    ----------
    out : Path
        The folder that `course grade` wrote.
    format : str
        "csv", "canvas", "moodle", "json" or "gradescope".
    roster : Path, optional
        The gradebook that was exported from Canvas, which "canvas" needs; or Moodle's grading
        worksheet. Its columns are kept. Who cannot be told for sure is not graded but listed in
        ``unmatched.txt``.
    assignment : str, optional
        The assignment's name in Canvas.

    Returns
    -------
    Path
        The file, in `out`.

    Raises
    ------
    ValueError
        The format is unknown, a roster is missing or is none, or nothing was graded.
    """
    if format not in FILES:
        raise ValueError(f"unknown format {format!r}; choose one of {', '.join(FILES)}")
    if format == "canvas" and roster is None:
        raise ValueError(
            "Canvas needs to know its own students: export the gradebook (Grades, Export) and "
            "give the file as --roster"
        )
    if roster is not None and format not in {"canvas", "moodle"}:
        raise ValueError(f"a roster is for canvas and moodle, not for {format}")
    if not out.is_dir():
        raise ValueError(f"{out} is not a folder")
    path = out / FILES[format]
    if roster is not None:
        atomic.write(path, _merged(out, format, roster, assignment))
    elif format == "gradescope":
        _write_zip(out, path)
    else:
        make = {"csv": _grades, "moodle": _moodle, "json": _json}[format]
        atomic.write(path, make(out))
    return path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what ``course export`` understands."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="what `course grade --out` wrote")
    parser.add_argument(
        "--format", choices=list(FILES), default="csv", help="what to write (default: csv)"
    )
    parser.add_argument(
        "--roster",
        type=Path,
        metavar="FILE",
        help="the gradebook exported from Canvas, or Moodle's grading worksheet, to be filled in",
    )
    parser.add_argument(
        "--assignment",
        default=ASSIGNMENT,
        metavar="NAME",
        help="the assignment's name in Canvas (default: %(default)s)",
    )


def main(args: argparse.Namespace) -> int:
    """Run ``course export``; return the exit status."""
    try:
        path = write(args.folder, args.format, args.roster, assignment=args.assignment)
    except (ValueError, OSError) as error:
        print(f"course export: {error}", file=sys.stderr)  # noqa: T201
        return 1
    print(path)  # noqa: T201
    unmatched = args.folder / UNMATCHED
    if args.roster is not None and (text := unmatched.read_text("utf-8")):
        print(f"Not everybody could be matched; see {unmatched}:\n{text}", file=sys.stderr)  # noqa: T201
    return 0


def feedback(summary: Summary) -> str:
    """Write in a few lines where points were lost, and why."""
    lost = [
        f"{test.number} {test.name} ({points(test.score)} of {points(test.max_score)}): "
        + (line(test.output, 600) or "no message")
        for test in summary.tests
        if test.score < test.max_score and test.visibility != "hidden"
    ]
    return "\n".join(lost or ["Everything is right."])


def guard(cell: str) -> str:
    """Keep a spreadsheet from taking a text for a formula.

    Examples
    --------
    >>> guard("=1+1"), guard("zoe")
    ("'=1+1", 'zoe')
    """
    return f"'{cell}" if cell.lstrip(" ").startswith(_FORMULA) else cell


def _csv(rows: Iterable[Sequence[str]]) -> bytes:
    text = io.StringIO()
    csv.writer(text).writerows(rows)
    return text.getvalue().encode("utf-8", errors="replace")


def _name(summary: Summary) -> str:
    return guard(line(summary.student, 200))


def _grades(out: Path) -> bytes:
    students = [
        (
            _name(found),
            points(found.score),
            points(found.max_score),
            {test.number: points(test.score) for test in found.tests},
        )
        for found in graded(out)
    ]
    numbers = sorted({number for *_, own in students for number in own}, key=in_order)
    header = ["student", "total", "max", *(guard(number) for number in numbers)]
    rows = ([*row, *(own.get(number, "") for number in numbers)] for *row, own in students)
    return _csv([header, *rows])


def _moodle(out: Path) -> bytes:
    rows = [
        (_participant(found.student) or _name(found), points(found.score), _comment(found))
        for found in graded(out)
    ]
    return _csv([("Identifier", "Grade", "Feedback comments"), *rows])


def _participant(student: str) -> str:
    # As Moodle names what is downloaded together: Zoe Ng_1234_assignsubmission_file_
    found = re.search(r"_([0-9]{1,18})_assignsubmission_", student)
    return f"Participant {found[1]}" if found else ""


def _comment(summary: Summary) -> str:
    # Moodle reads a comment as HTML.
    return guard(html.escape(feedback(summary), quote=False))


def _json(out: Path) -> bytes:
    students = []
    for found in graded(out):
        tests = [
            {
                "number": test.number,
                "name": test.name,
                "score": test.score,
                "max_score": test.max_score,
                "status": test.status,
            }
            for test in found.tests
        ]
        about = {
            "student": found.student,
            "folder": found.folder,
            "score": found.score,
            "max_score": found.max_score,
            "status": found.status,
            "tests": tests,
            "notes": found.notes,
            "events": found.events,
        }
        students.append(json.dumps(about))
    return ('{"students": [\n' + ",\n".join(students) + "\n]}\n").encode("ascii")


def _merged(out: Path, format: str, roster: Path, assignment: str) -> bytes:  # noqa: A002
    table = rosters.read(roster)
    found = list(graded(out))
    names = [_participant(one.student) or one.student for one in found]
    matching = rosters.match(table, names)
    if format == "canvas":
        score = table.column(assignment, like=rf"{re.escape(assignment)} \([0-9]+\)")
        table.fill_maximum(score, points(max((one.max_score for one in found), default=0.0)))
        comment = None
    else:
        score, comment = table.column("Grade"), table.column("Feedback comments")
    for index, row in matching.rows.items():
        table.rows[row][score] = points(found[index].score)
        if comment is not None:
            table.rows[row][comment] = _comment(found[index])
    listed = [f"{line(found[i].student, 200)}: {why}" for i, why in matching.unmatched.items()]
    atomic.write(out / UNMATCHED, "".join(f"{one}\n" for one in listed).encode("utf-8", "replace"))
    return _csv([table.header, *(table.guarded(row, guard) for row in table.rows)])


def _write_zip(out: Path, path: Path) -> None:
    with (
        atomic.replacing(path) as file,
        zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive,
    ):
        for found in graded(out):
            # The same grades give the same bytes; a name may hold what no zip can.
            name = os.fsencode(found.folder).decode("utf-8", "backslashreplace")
            entry = zipfile.ZipInfo(f"{name}/{RESULTS}")
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, (out / found.folder / RESULTS).read_bytes())
