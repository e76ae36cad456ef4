"""``course check NOTEBOOK``: run a saved notebook and check what it defines."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.checks.table import Row, Table, Verdict

if TYPE_CHECKING:
    import argparse

MIME = "application/vnd.course.check+json"
_EXERCISE = re.compile(r"4\D?([12])(?!\d)")
_SECONDS = 120.0
# Runs after the student's last cell, in the same kernel.
_QUESTION = """
from course_lib.checks import command as _command
_command.publish({exercise!r}, globals())
"""


class CannotCheckError(Exception):
    """A notebook cannot be checked at all; the message says why."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``course check``."""
    parser.add_argument(
        "notebooks", nargs="+", type=Path, help="such as exercises/exercise_4_1.ipynb"
    )
    parser.add_argument("--json", action="store_true", help="print data instead of a table")
    parser.add_argument(
        "--exercise", choices=("4.1", "4.2"), help="which it is; default: what the file's name says"
    )


def check_notebooks(args: argparse.Namespace) -> int:
    """Check each notebook; return 0 (all right), 1 (something is not) or 2 (cannot tell)."""
    tables: list[Table] = []
    problems: list[str] = []
    for path in args.notebooks:
        try:
            tables.append(check_notebook(path, args.exercise))
        except (CannotCheckError, OSError) as error:
            problems.append(f"{path}: {error}")
            continue
        if not args.json:
            print(tables[-1])  # noqa: T201
    if args.json:
        print(json.dumps([table.as_dict() for table in tables], ensure_ascii=False))  # noqa: T201
    for problem in problems:
        print(problem, file=sys.stderr)  # noqa: T201
    if problems:
        return 2
    return 0 if all(table.is_right for table in tables) else 1


def check_notebook(path: Path, exercise: str | None = None) -> Table:
    """
    Run a notebook from its first cell and check it; the file stays as it is.

    A cell that raises does not stop the others: what it would have defined is "not yet".

    Parameters
    ----------
    path : Path
        The notebook; it runs in its own folder.
    exercise : str or None
        "4.1" or "4.2"; None asks the file's name.

    Returns
    -------
    Table

    Raises
    ------
    CannotCheckError
        No such exercise, no notebook, or it does not run to its end.
    OSError
        The file cannot be read.
    """
    # Kernels and notebooks take half a second to import, too long for --help.
    import nbformat  # noqa: PLC0415
    from nbformat.v4 import new_code_cell  # noqa: PLC0415

    from course_lib.publish.runner import NotebookFailed, run_notebook  # noqa: PLC0415

    exercise = exercise or _named(path)
    try:
        notebook = nbformat.read(path, as_version=4)  # type: ignore[no-untyped-call]
    except (ValueError, nbformat.reader.NotJSONError) as error:
        raise CannotCheckError("this is not a notebook, or it was saved half-way") from error
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.metadata.tags = [*cell.metadata.get("tags", []), "raises-exception"]
    question = _QUESTION.format(exercise=exercise).strip()
    notebook.cells.append(new_code_cell(question))  # type: ignore[no-untyped-call]
    try:
        # Without the widgets' state, nbclient knows no Output widget, which @interact makes.
        ran = run_notebook(path, notebook=notebook, cell_timeout=_SECONDS, keep_widget_state=True)
    except NotebookFailed as error:
        raise CannotCheckError(str(error)) from error
    for output in ran.cells[-1].outputs:
        if MIME in output.get("data", {}):
            return _as_table(output["data"][MIME])
    raise CannotCheckError("the checks did not come to an end: was something of Python redefined?")


def publish(exercise: str, namespace: dict[str, Any]) -> None:
    """Show a check's table as data, for the process that runs the notebook."""
    from IPython.display import display  # noqa: PLC0415 (in the notebook's kernel only)

    from course_lib.check import check  # noqa: PLC0415 (imports this file)

    table = check(exercise, namespace=namespace)
    display({MIME: table.as_dict(), "text/plain": repr(table)}, raw=True)  # type: ignore[no-untyped-call]


def _named(path: Path) -> str:
    found = _EXERCISE.search(path.stem)
    if not found:
        raise CannotCheckError("which exercise is this? Say --exercise 4.1 or --exercise 4.2")
    return f"4.{found[1]}"


def _as_table(data: dict[str, Any]) -> Table:
    rows = tuple(Row(**{**row, "verdict": Verdict(row["verdict"])}) for row in data["rows"])
    return Table(data["exercise"], rows)
