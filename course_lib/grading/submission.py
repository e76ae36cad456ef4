"""
Finds what students handed in and makes it gradable: one folder of plain files for each.

Whatever the files hold, there is a `Submission`: what was forgiven is noted for the student, what
looks wrong for the instructor, and an exercise that cannot be graded says why.
"""

from __future__ import annotations

import hashlib
import itertools
import os
import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path  # noqa: TC003  (dataclasses are read at run time)
from types import MappingProxyType
from typing import TYPE_CHECKING

import nbformat

from course_lib.grading.intake import missing, notebooks
from course_lib.grading.intake.files import ARCHIVES, Copier, safe_name, tree
from course_lib.grading.text import clean

if TYPE_CHECKING:
    from collections.abc import Mapping

_LOOSE = re.compile(r"^(.*?)[\s_-]*(?:exercise|ex)?[\s_-]*4[\W_]?[12](?!\d).*$", re.IGNORECASE)
_MOST_LABEL = 80
_ODD = re.compile(
    r"^(conftest\.py|pytest\.ini|tox\.ini|setup\.cfg|(site|user)customize\.py|.*\.pth)$"
)


@dataclass(frozen=True)
class Source:
    """Where one student's work lies.

    Attributes
    ----------
    student : str
        A label that is safe as a folder's name, and unique.
    paths : tuple of Path
        A folder, an archive, or loose notebooks.
    """

    student: str
    paths: tuple[Path, ...]


@dataclass(frozen=True)
class Submission:
    """One student's work, staged.

    Attributes
    ----------
    student : str
    folder : Path
        Regular files only; holds the notebooks and, if there is one, `unit4`.
    notebooks : mapping of str to Path
        Exercise to its notebook: nbformat 4.5, without outputs.
    notes : tuple of str
        For the student: what was forgiven.
    events : tuple of str
        For the instructor: what looks odd.
    problems : mapping of str to str
        Exercise to why it cannot be graded, for the student.
    digest : str
        Changes with any name, mode or byte of the files.
    """

    student: str
    folder: Path
    notebooks: Mapping[str, Path]
    notes: tuple[str, ...] = ()
    events: tuple[str, ...] = ()
    problems: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    digest: str = ""


def find_submissions(root: Path) -> list[Source]:
    """List the submissions in a folder.

    Parameters
    ----------
    root : Path
        Holds for each student a folder, an archive, or notebooks whose names begin with theirs.

    Returns
    -------
    list of Source
        Sorted by student.

    Raises
    ------
    FileNotFoundError
        When there is no such folder.
    NotADirectoryError
        When it is a file.
    """
    if not root.exists():
        raise FileNotFoundError(f"there is no folder {root}")
    if not root.is_dir():
        raise NotADirectoryError(f"{root} is a file; give the folder that holds the submissions")
    found: dict[str, list[Path]] = {}
    for path in sorted(root.iterdir()):
        student = _student(path)
        if student is not None:
            found.setdefault(_label(student), []).append(path)
    return [Source(student, tuple(paths)) for student, paths in sorted(found.items())]


def passed_over(root: Path) -> list[str]:
    """List what lies in a folder of submissions and is taken for none, hidden files apart."""
    paths = sorted(path for path in root.iterdir() if not path.name.startswith("."))
    return [path.name for path in paths if _student(path) is None]


def _student(path: Path) -> str | None:
    """Tell whose submission something is, from its name; None when it looks like none."""
    name = path.name
    if name.startswith((".", "_")):
        return None
    if path.is_dir() or path.is_symlink():
        return name
    suffix = next((s for s in (*ARCHIVES, *missing.PACKED) if name.lower().endswith(s)), None)
    if suffix in ARCHIVES:
        return name[: -len(suffix)]
    # A notebook, or what became of it: exercise_4_1.ipynb.txt, exercise_4_1.pdf. Or an archive
    # that nobody here can open: its student must learn so.
    match = _LOOSE.match(path.stem)
    if match or suffix or path.suffix.lower() in {".ipynb", ".py"}:
        return match[1] if match and match[1] else path.stem
    return None


def _label(name: str) -> str:
    """Make a name that is safe as a folder and in a table, and still tells names apart."""
    kept = re.sub(r"[^\w.@+ -]", "_", safe_name(name)).strip(" .")[:_MOST_LABEL] or "unnamed"
    if kept != name:
        kept = f"{kept[: _MOST_LABEL - 7]}-{hashlib.sha256(os.fsencode(name)).hexdigest()[:6]}"
    return kept


def stage(source: Source, into: Path) -> Submission:
    """Copy a submission, safely, and find its notebooks.

    Parameters
    ----------
    source : Source
        As `find_submissions` gives it.
    into : Path
        A new folder.

    Returns
    -------
    Submission
    """
    into.mkdir(parents=True)
    copier = Copier(into)
    for path in source.paths:
        copier.copy(path)
    _unpack_nested(copier)
    digest = hashlib.sha256()
    for path in tree(into):
        mode = path.stat().st_mode & 0o100
        digest.update(f"{path.relative_to(into)}\0{mode}\0{path.stat().st_size}\0".encode())
        digest.update(path.read_bytes())
        if _ODD.match(path.name):
            copier.events.append(f"holds {clean(path.name, 60)}, which is not used")
    found, broken = _read_all(into)
    chosen: dict[str, notebooks.Found] = {}
    problems: dict[str, str] = {}
    for exercise in notebooks.FUNCTIONS:
        best = max(found, key=lambda f: f.belongs_to(exercise), default=None)
        if best is None or not any(best.belongs_to(exercise)[:3]):
            problems[exercise] = missing.describe(exercise, copier, broken)
            copier.events += [
                f"{clean(path.name, 90)} could not be read, and nothing else is Exercise {exercise}"
                for path, _ in broken
                if not notebooks.named_for_another(path, exercise)
            ]
            continue
        chosen[exercise] = best
        usual = f"exercise_{exercise.replace('.', '_')}.ipynb"
        if best.path.name != usual:
            copier.notes.append(
                f"{clean(best.path.name, 100)} was taken as your notebook of Exercise {exercise}."
            )
    folder = _base(into, chosen, copier)
    paths = {}
    for exercise, best in chosen.items():
        paths[exercise] = folder / f"exercise_{exercise.replace('.', '_')}.ipynb"
        _make_room(paths[exercise])
        nbformat.write(best.notebook, paths[exercise])  # type: ignore[no-untyped-call]
    return Submission(
        student=source.student,
        folder=folder,
        notebooks=MappingProxyType(paths),
        notes=tuple(copier.notes),
        events=tuple(copier.events),
        problems=MappingProxyType(problems),
        digest=digest.hexdigest(),
    )


def _unpack_nested(copier: Copier) -> None:
    """Unpack archives within the submission, once; not those within them."""
    for path in tree(copier.into):
        if path.name.lower().endswith(ARCHIVES):
            copier.archive(path)
            path.unlink()


def _read_all(folder: Path) -> tuple[list[notebooks.Found], list[tuple[Path, str]]]:
    found, broken = [], []
    for path in tree(folder):
        if path.suffix.lower() == ".ipynb":
            try:
                found.append(notebooks.read(path))
            except notebooks.UnreadableError as error:
                broken.append((path, notebooks.describe(path, error)))
    if not found:
        scripts = [p for p in tree(folder) if p.suffix.lower() == ".py" and "unit4" not in p.parts]
        for path in scripts:
            try:
                script = notebooks.read(path)
            except notebooks.UnreadableError as error:
                broken.append((path, notebooks.describe(path, error)))
                continue
            if any(sum(script.belongs_to(exercise)[:1]) for exercise in notebooks.FUNCTIONS):
                found.append(script)
    return found, broken


def _base(into: Path, chosen: Mapping[str, notebooks.Found], copier: Copier) -> Path:
    """Give the folder that holds the notebooks, and bring `unit4` there."""
    base = next((best.path.parent for best in chosen.values()), into)
    package = base / "unit4"
    if not package.is_dir() and any(path.name.lower() == "package.xml" for path in base.iterdir()):
        _wrap(base, package)
        copier.notes.append("Your package's files lie beside the notebook, not in a folder unit4.")
    if not package.is_dir():
        candidates = [path.parent for path in tree(into) if path.name.lower() == "package.xml"]
        candidates += [
            path for path in into.rglob("*") if path.is_dir() and path.name.lower() == "unit4"
        ]
        if candidates and base not in candidates and not base.is_relative_to(candidates[0]):
            _make_room(package)
            shutil.move(candidates[0], package)
            where = candidates[0].relative_to(into)
            copier.notes.append(f"Your package was found in {clean(str(where), 100)}.")
    return base


def _wrap(base: Path, package: Path) -> None:
    """Make a package of the files around a notebook, which keeps them, too."""
    _make_room(package)
    others = [path for path in base.iterdir() if path.suffix != ".ipynb"]
    package.mkdir()
    for path in others:
        copy = shutil.copytree if path.is_dir() else shutil.copy2
        copy(path, package / path.name)


def _make_room(path: Path) -> None:
    """Give what has a name that is needed, and is something else than it should be, another."""
    if path.exists() and (path.is_dir() or path.suffix != ".ipynb"):
        others = (path.with_name(f"{path.name}.{number}") for number in itertools.count(2))
        path.rename(next(other for other in others if not other.exists()))
