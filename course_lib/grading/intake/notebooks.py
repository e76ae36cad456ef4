"""Reads notebooks of any age and state, as data; tells which exercise each belongs to."""

from __future__ import annotations

import ast
import json
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from nbformat import v4

from course_lib.grading.text import clean

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path, PurePath

    from nbformat import NotebookNode

FUNCTIONS = {
    "4.1": ("load_images", "find_keypoints", "match_keypoints", "locate_mug"),
    "4.2": ("crop_waterhole", "locate_waterhole", "best_match_count"),
}
_MOST_CELLS = 1000
_MOST_SOURCE = 2_000_000  # characters
_DEFINES = re.compile(r"^(?:async\s+)?def\s+(\w+)|^(\w+)\s*(?::[^=\n]+)?=(?!=)", re.MULTILINE)
_BLOCK = re.compile(r"^# ?%%.*$|^# In\[.*\]:?\s*$", re.MULTILINE)
_FILE_NAME = re.compile(r"4[\W_]?([12])(?!\d)")


class UnreadableError(ValueError):
    """The file is not a notebook; the message is for the student."""


@dataclass(frozen=True)
class Found:
    """A notebook that was read.

    Attributes
    ----------
    path : Path
        Where it was.
    notebook : NotebookNode
        As nbformat 4.5: its code and text, no outputs, no metadata.
    defined : frozenset of str
        The names that its code defines at top level.
    done : int
        How many of the exercises' functions do more than raise NotImplementedError.
    """

    path: Path
    notebook: NotebookNode
    defined: frozenset[str]
    done: int

    def belongs_to(self, exercise: str) -> tuple[int, int, bool, str]:
        """
        Rank how well it fits an exercise: the more, the better; all zero, not at all.

        Both exercises have a function `find_keypoints`. So what is named for the other exercise
        alone must hold most of this one's functions to be taken for it.
        """
        number = sum(name in self.defined for name in FUNCTIONS[exercise])
        if named_for_another(self.path, exercise) and 2 * number <= len(FUNCTIONS[exercise]):
            number = 0
        return (
            number,
            self.done if number else 0,
            exercise[-1] in _FILE_NAME.findall(self.path.stem),
            self.path.name,
        )


def named_for_another(path: PurePath, exercise: str) -> bool:
    """Tell whether a file's name speaks of another exercise, and not of this one."""
    numbers = _FILE_NAME.findall(path.stem)
    return bool(numbers) and exercise[-1] not in numbers


def read(path: Path) -> Found:
    """Read a notebook, or a script as if it were one.

    Parameters
    ----------
    path : Path
        A regular file.

    Returns
    -------
    Found

    Raises
    ------
    UnreadableError
        When it holds no notebook; says why and what to do.
    """
    text = _decode(path.read_bytes())
    if path.suffix.lower() == ".py":
        cells = [("code", block) for block in _BLOCK.split(text)]
    else:
        cells = list(_cells(_json(text)))
    notebook: NotebookNode = v4.new_notebook(  # type: ignore[no-untyped-call]
        metadata={
            "kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}
        }
    )
    left = _MOST_SOURCE
    for number, (kind, source) in enumerate(cells[:_MOST_CELLS]):
        left -= len(source)
        if left < 0:
            raise UnreadableError("holds more than two million characters of code and text")
        make = v4.new_code_cell if kind == "code" else v4.new_markdown_cell
        cell: NotebookNode = make(source, id=f"cell-{number}")  # type: ignore[no-untyped-call]
        notebook.cells.append(cell)
    sources = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
    names = {a or b for source in sources for a, b in _DEFINES.findall(source)}
    return Found(path, notebook, frozenset(names), sum(map(_done, sources)))


def _decode(data: bytes) -> str:
    if data.startswith((b"\xff\xfe\0\0", b"\0\0\xfe\xff")):
        return data.decode("utf-32", "replace")
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16", "replace")
    if b"\x00" in data[:4]:
        return data.decode("utf-16-le" if data[1:2] == b"\x00" else "utf-16-be", "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def _json(text: str) -> Any:  # noqa: ANN401
    if not text.strip():
        raise UnreadableError("is empty")
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        if error.pos >= len(text.rstrip()) - 1 or "Unterminated" in error.msg:
            raise UnreadableError(
                f"ends in the middle (line {error.lineno}): it was not saved or sent completely"
            ) from error
        raise UnreadableError(f"is not a notebook: {error.msg} in line {error.lineno}") from error
    except RecursionError as error:
        raise UnreadableError("is not a notebook: it is nested too deeply") from error
    except ValueError as error:  # thousands of digits
        raise UnreadableError("is not a notebook: it holds a number without end") from error


def _cells(content: Any) -> Iterator[tuple[str, str]]:  # noqa: ANN401
    """Give kind and source of each cell, of nbformat 4 and of 3 with its worksheets."""
    if not isinstance(content, dict):
        raise UnreadableError("is not a notebook: it holds no cells")
    cells = content.get("cells")
    if not isinstance(cells, list):
        sheets = content.get("worksheets")
        if not isinstance(sheets, list):
            raise UnreadableError("is not a notebook: it holds no cells")
        lists = [sheet.get("cells") for sheet in sheets if isinstance(sheet, dict)]
        cells = [cell for each in lists if isinstance(each, list) for cell in each]
    for cell in cells:
        if isinstance(cell, dict):
            kind = "code" if cell.get("cell_type") == "code" else "markdown"
            yield kind, _text(cell.get("source", cell.get("input", "")))


def _text(source: object) -> str:
    if isinstance(source, list):
        source = "".join(line for line in source if isinstance(line, str))
    # A lone surrogate is JSON but no text: nothing could execute or save it.
    return source.encode("utf-8", "replace").decode() if isinstance(source, str) else ""


def _done(source: str) -> int:
    """Count the exercises' functions in a cell that are more than a stub."""
    wanted = {name for names in FUNCTIONS.values() for name in names}
    try:
        # Blanks, not `\s`: from each of many empty lines a search would run over all that follow.
        nodes = ast.parse(re.sub(r"^[ \t]*[%!].*$", "", source, flags=re.MULTILINE)).body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return 0
    functions = [
        node for node in nodes if isinstance(node, ast.FunctionDef) and node.name in wanted
    ]
    return sum(
        not (isinstance(node.body[-1], ast.Raise) and _is_stub(node.body[-1])) for node in functions
    )


def _is_stub(node: ast.Raise) -> bool:
    what = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
    return isinstance(what, ast.Name) and what.id == "NotImplementedError"


def describe(path: Path, error: UnreadableError) -> str:
    """Word for the student why a file could not be read."""
    return (
        f"Your file {clean(path.name, 100)} {error}. Open it in JupyterLab, save it, send it again."
    )
