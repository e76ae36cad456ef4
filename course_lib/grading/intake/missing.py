"""Says why there is no notebook of an exercise: what was handed in in its stead."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from course_lib.grading.intake.files import ARCHIVES, Copier, tree
from course_lib.grading.intake.notebooks import named_for_another
from course_lib.grading.text import clean

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path, PurePath

# What `Copier` does not open; students' programs make them.
PACKED = (".7z", ".rar", ".gz", ".bz2", ".xz", ".zst", ".lzma", ".tbz2", ".txz", ".zipx")
_MOST_NAMES = 5
_MOST_NAME = 60


def is_packed(path: PurePath) -> bool:
    """Tell whether a file is an archive, or one packed file, of a kind that is not opened."""
    name = path.name.lower()
    return name.endswith(PACKED) and not name.endswith(ARCHIVES)


def describe(exercise: str, copier: Copier, broken: Sequence[tuple[Path, str]]) -> str:
    """Word for the student why an exercise cannot be graded.

    Parameters
    ----------
    exercise : str
        Such as ``"4.1"``.
    copier : Copier
        It has copied the submission.
    broken : sequence of (Path, str)
        Notebooks that could not be read, and why in whole sentences.

    Returns
    -------
    str
    """
    said = [f"There is no notebook of Exercise {exercise} in your submission."]
    about = {
        clean(path.name, 100): why for path, why in broken if not named_for_another(path, exercise)
    }
    said += about.values()
    said += [
        f"{_short(name)} {reason} and was left out."
        for name, reason in copier.left_out[:_MOST_NAMES]
        if not named_for_another(PurePosixPath(name), exercise)
    ]
    files = tree(copier.into)
    others = [
        path.relative_to(copier.into)
        for path in files
        if path.suffix.lower() not in {".ipynb", ".py"} and "unit4" not in path.parts
    ]
    others = [path for path in others if not named_for_another(path, exercise)]
    if others and not about:
        names = ", ".join(_short(str(path)) for path in others[:_MOST_NAMES])
        more = f" and {len(others) - _MOST_NAMES} more" if len(others) > _MOST_NAMES else ""
        said.append(f"It holds {names}{more}: a notebook's name ends with .ipynb.")
    if any(map(is_packed, others)):
        said.append("Of archives, .zip and .tar.gz are opened: pack your work anew.")
    if not files and not copier.left_out and not copier.notes:
        said.append("It holds no files; folders such as .ipynb_checkpoints are not looked into.")
    return " ".join(said)


def _short(name: str) -> str:
    return clean(name, _MOST_NAME).replace("\n", " ")
