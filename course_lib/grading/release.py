"""
Make what students get from ``solutions/``: ``course release``.

``exercises/`` holds the same notebooks and the same ROS package without their solution regions
(see `course_lib.grading.regions`), without outputs, with the same cell ids and tags.
"""

from __future__ import annotations

import argparse
import ast
import sys
from dataclasses import dataclass
from pathlib import Path

import nbformat

from course_lib.grading.bundle import write_bundle
from course_lib.grading.regions import ReleaseError, without_solutions

__all__ = ["ReleaseError", "Released", "add_arguments", "drift", "main", "release", "write"]

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = "exercise_*.ipynb"
PACKAGE = "unit4"
# The node of Example 4.5 lies with the solutions, but it is no exercise; Exercise 4.1 is asked for
# as a notebook, and its script is the answer.
_STAYS = ("example", "exercise4_1")
_JUNK = {"__pycache__", ".ipynb_checkpoints"}
# The template in the package is what the notebook cuts out: the student's to make.
_MADE = {".png"}
# The one file of exercises/ that is written by hand.
_BY_HAND = "README.md"


@dataclass(frozen=True)
class Released:
    """A file of ``exercises/``: its bytes, and whether it may be executed."""

    data: bytes
    executable: bool = False


def release(solutions: Path) -> dict[str, Released]:
    """
    Make the exercises from their solutions.

    Parameters
    ----------
    solutions : Path
        The folder of the complete exercises.

    Returns
    -------
    dict of str to Released
        By path within ``exercises/``.

    Raises
    ------
    ReleaseError
        A solution region is not marked as it should be, or its stub is not Python.
    OSError
        There is no notebook, or a file cannot be read.
    """
    notebooks = sorted(solutions.glob(NOTEBOOKS))
    if not notebooks:
        raise FileNotFoundError(f"there is no {NOTEBOOKS} in {solutions}")
    files = {path.name: Released(_notebook(path)) for path in notebooks}
    for path in sorted((solutions / PACKAGE).rglob("*")):
        is_junk = _JUNK.intersection(path.parts) or path.name.startswith((*_STAYS, "."))
        if path.is_file() and not is_junk and path.suffix not in _MADE:
            name = path.relative_to(solutions).as_posix()
            text = without_solutions(path.read_text(encoding="utf-8"), name)
            if path.suffix == ".py":
                _must_be_python(text, name)
            files[name] = Released(text.encode(), bool(path.stat().st_mode & 0o100))
    return files


def _notebook(path: Path) -> bytes:
    notebook = nbformat.read(path, as_version=4)  # type: ignore[no-untyped-call]
    for cell in notebook.cells:
        where = f"{path.name}, cell {cell.id}"
        cell.source = without_solutions(cell.source, where)
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
            _must_be_python(cell.source, where)
    text: str = nbformat.writes(notebook)  # type: ignore[no-untyped-call]
    return (text.rstrip("\n") + "\n").encode()


def _must_be_python(source: str, where: str) -> None:
    try:
        ast.parse(source)
    except SyntaxError as error:
        raise ReleaseError(f"{where}: without its solution this is not Python: {error}") from error


def _present(exercises: Path) -> dict[str, Released]:
    return {
        path.relative_to(exercises).as_posix(): Released(
            path.read_bytes(), bool(path.stat().st_mode & 0o100)
        )
        for path in sorted(exercises.rglob("*"))
        if path.is_file()
        and not _JUNK.intersection(path.parts)
        and path.relative_to(exercises).as_posix() != _BY_HAND
    }


def drift(files: dict[str, Released], exercises: Path) -> list[str]:
    """Say of each file of ``exercises/`` that is not as released what is wrong with it."""
    present = _present(exercises)
    problems = [f"{name} is missing" for name in files if name not in present]
    problems += [f"{name} does not come from solutions/" for name in present if name not in files]
    for name in files.keys() & present.keys():
        if files[name].data != present[name].data:
            problems.append(f"{name} differs from what solutions/ gives")
        elif files[name].executable != present[name].executable:
            problems.append(f"{name} has the wrong execute permission")
    return sorted(problems)


def write(files: dict[str, Released], exercises: Path) -> list[str]:
    """Bring ``exercises/`` to what was released; return what was wrong before."""
    problems = drift(files, exercises)
    for name in _present(exercises).keys() - files.keys():
        (exercises / name).unlink()
    for name, file in files.items():
        path = exercises / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(file.data)
        path.chmod(0o755 if file.executable else 0o644)
    return problems


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``course release``."""
    parser.add_argument("--check", action="store_true", help="change nothing; fail on a difference")
    parser.add_argument(
        "--bundle", type=Path, metavar="FILE.zip", help="also write all that a student needs"
    )


def main(args: argparse.Namespace) -> int:
    """Run ``course release``; return the exit status (0: all is as it should be)."""
    try:
        files = release(ROOT / "solutions")
        if args.check:
            problems = drift(files, ROOT / "exercises")
        else:
            for problem in write(files, ROOT / "exercises"):
                print(f"exercises/{problem}: written anew")  # noqa: T201
            problems = []
        if args.bundle:
            members = {f"exercises/{name}": (f.data, f.executable) for name, f in files.items()}
            count = write_bundle(ROOT, members, args.bundle)
            print(f"{args.bundle}: {count} files for students")  # noqa: T201
    except (OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)  # noqa: T201
        return 2
    for problem in problems:
        print(f"exercises/{problem}", file=sys.stderr)  # noqa: T201
    if problems:
        print("Run `course release`: exercises/ is made from solutions/.", file=sys.stderr)  # noqa: T201
        return 1
    print("exercises/ is as solutions/ gives it")  # noqa: T201
    return 0


if __name__ == "__main__":
    _parser = argparse.ArgumentParser(
        prog="course release", description="Make exercises/, and the students' bundle."
    )
    add_arguments(_parser)
    sys.exit(main(_parser.parse_args()))
