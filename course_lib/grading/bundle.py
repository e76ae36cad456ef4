"""
The students' bundle: one zip with the course and the exercises, and nothing that grades them.

What goes in is listed here; anything else, such as a new folder of tests, stays out by default.
The same sources give the same bytes.
"""

from __future__ import annotations

import zipfile
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

FOLDER = "feature-matching"
# (folder, pattern); the library follows below, as it has parts that stay out.
_CONTENTS = (
    ("notebooks", "*.ipynb"),
    ("images", "*.png"),
    ("images", "*.jpg"),
    ("images", "*.bag"),
    ("images/truth", "*.json"),
    ("exercises", "README.md"),
    # The node that Example 4.5 runs: an example, no solution.
    ("solutions/unit4/src", "example4_5.py"),
    ("solutions/unit4/launch", "example4_5.launch"),
    ("solutions/unit4_ros2", "example4_5.py"),
    (".ci", "environment"),
    (".ci", "lab"),
    (".", "LICENSE"),
    (".", "pyproject.toml"),
    (".", "requirements.lock"),
)
_LIBRARY = "course_lib"
_LIBRARY_SUFFIXES = {".py", ".js", ".css", ".html", ".j2", ".typed", ".npz"}
_STAYS_OUT = {"grading", "scenes"}
_TEMPLATES = "course_lib/grading/bundle_files"


def write_bundle(root: Path, exercises: Mapping[str, tuple[bytes, bool]], target: Path) -> int:
    """
    Write the students' zip.

    Parameters
    ----------
    root : Path
        The repository.
    exercises : mapping of str to (bytes, bool)
        The released exercises by path from the root: content, and whether executable.
    target : Path
        The zip; its folder must exist.

    Returns
    -------
    int
        How many files it holds.

    Raises
    ------
    OSError
        Something is missing, or the zip cannot be written.
    """
    members = {**dict(_from_repository(root)), **exercises}
    draft = target.with_name(f".{target.name}.part")
    try:
        with zipfile.ZipFile(draft, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
            for name in sorted(members):
                data, executable = members[name]
                # No date of its own, or the same sources would give different bytes tomorrow.
                info = zipfile.ZipInfo(f"{FOLDER}/{name}", date_time=(1980, 1, 1, 0, 0, 0))
                info.compress_type = zipfile.ZIP_DEFLATED
                info.create_system = 3
                info.external_attr = (0o100755 if executable else 0o100644) << 16
                archive.writestr(info, data)
        draft.replace(target)
    finally:
        draft.unlink(missing_ok=True)
    return len(members)


def _from_repository(root: Path) -> Iterator[tuple[str, tuple[bytes, bool]]]:
    for folder, pattern in _CONTENTS:
        paths = sorted((root / folder).glob(pattern))
        if not paths:
            raise FileNotFoundError(f"there is no {folder}/{pattern} to put into the bundle")
        for path in paths:
            yield path.relative_to(root).as_posix(), _content(path)
    for path in sorted((root / _LIBRARY).rglob("*")):
        part = path.relative_to(root / _LIBRARY).parts[0]
        if path.suffix in _LIBRARY_SUFFIXES and part.removesuffix(".py") not in _STAYS_OUT:
            yield path.relative_to(root).as_posix(), _content(path)
    for path in sorted((root / _TEMPLATES).iterdir()):
        yield path.name, _content(path)


def _content(path: Path) -> tuple[bytes, bool]:
    return path.read_bytes(), bool(path.stat().st_mode & 0o100)
