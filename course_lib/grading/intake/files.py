"""
Copies a stranger's folder or archive: regular files only, inside limits, following nothing.

What is left out is told, not raised: one odd file must not cost a student the rest.
"""

from __future__ import annotations

import errno
import os
import stat
import tarfile
import unicodedata
import zipfile
from pathlib import Path, PurePosixPath
from typing import IO, TYPE_CHECKING, Any

from course_lib.grading.intake.streams import unpacked
from course_lib.grading.text import clean

if TYPE_CHECKING:
    from collections.abc import Iterable

MOST_BYTES = 128 * 2**20
MOST_FILE_BYTES = 64 * 2**20
MOST_FILES = 1000
MOST_DEPTH = 10
_MOST_ENTRIES = 20_000
_MOST_NAME = 150
_CHUNK = 1 << 16
_OURS = {errno.ENOSPC, errno.EDQUOT, errno.EMFILE, errno.ENFILE, errno.ENOMEM}
_JUNK = frozenset(
    ["__MACOSX", ".DS_Store", ".ipynb_checkpoints", ".git", "node_modules", "venv", ".venv"]
    + ["__pycache__", "Thumbs.db", "desktop.ini", ".idea", ".vscode", ".pytest_cache"]
)
ARCHIVES = (".zip", ".tar", ".tar.gz", ".tgz", ".tar.bz2", ".tar.xz")


class Copier:
    """Copies into one folder, counting.

    Parameters
    ----------
    into : Path
        Exists and is empty; nobody else writes there.

    Attributes
    ----------
    notes : list of str
        For the student.
    events : list of str
        For the instructor: what looks like an attack or an accident.
    left_out : list of (str, str)
        Names of files that were not copied, and why, in words that follow the name.
    """

    def __init__(self, into: Path) -> None:
        self.into = into
        self.notes: list[str] = []
        self.events: list[str] = []
        self.left_out: list[tuple[str, str]] = []
        self._bytes = 0
        self._files = 0
        self._full = False

    def copy(self, path: Path) -> None:
        """Copy a file, the content of a folder, or the content of an archive.

        Parameters
        ----------
        path : Path
            What a student handed in.

        Raises
        ------
        OSError
            When the grader's own disk is full, or it lacks what no student took from it.
        """
        try:
            status = path.lstat()
            if stat.S_ISDIR(status.st_mode):
                descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
                self._folder(descriptor, PurePosixPath())
            elif not stat.S_ISREG(status.st_mode):
                self._left_out(path.name, _kind(status.st_mode))
            elif path.name.lower().endswith(ARCHIVES):
                self.archive(path)
            else:
                self._one(os.open(path.parent, os.O_RDONLY), path.name, PurePosixPath(path.name))
        except OSError as error:
            _raise_ours(error)
            self._left_out(path.name, f"cannot be read ({error.strerror})")

    def archive(self, path: Path) -> None:
        """Copy the content of an archive."""
        try:
            if path.name.lower().endswith(".zip"):
                with zipfile.ZipFile(path) as archive:
                    self._zip(archive)
            else:
                with unpacked(path) as stream, tarfile.open(fileobj=stream) as tar:
                    self._tar(tar)
        except Exception as error:  # noqa: BLE001  (a stranger's archive may break any reader of it)
            _raise_ours(error)
            self._broken(path.name, error)

    def _broken(self, name: str, error: Exception) -> None:
        reason = clean(str(error), 200)
        self.notes.append(f"The archive {clean(name, 100)} is damaged or odd ({reason}).")

    def _folder(self, descriptor: int, inside: PurePosixPath) -> None:
        with os.scandir(descriptor) as entries:
            names = [entry.name for entry, _ in zip(entries, range(_MOST_ENTRIES), strict=False)]
            names.sort(key=_importance)
        try:
            for name in names:
                self._entry(descriptor, name, inside)
        finally:
            os.close(descriptor)

    def _entry(self, folder: int, name: str, inside: PurePosixPath) -> None:
        if name in _JUNK or self._full:
            return
        try:
            mode = os.stat(name, dir_fd=folder, follow_symlinks=False).st_mode
            if stat.S_ISDIR(mode):
                if len(inside.parts) >= MOST_DEPTH:
                    self._left_out(name, "lies too deep")
                    return
                flags = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW
                self._folder(os.open(name, flags, dir_fd=folder), inside / name)
            elif stat.S_ISREG(mode):
                self._one(os.dup(folder), name, inside / name)
            else:
                self._left_out(name, _kind(mode))
        except OSError as error:
            _raise_ours(error)
            self._left_out(name, f"cannot be read ({error.strerror})")

    def _one(self, folder: int, name: str, target: PurePosixPath) -> None:
        # Between looking and opening a file may be exchanged: so no waiting, no following, and a
        # second look at what was really opened.
        try:
            flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK
            descriptor = os.open(name, flags, dir_fd=folder)
        finally:
            os.close(folder)
        with os.fdopen(descriptor, "rb") as file:
            status = os.fstat(descriptor)
            if not stat.S_ISREG(status.st_mode):
                self._left_out(name, _kind(status.st_mode))
            elif status.st_nlink > 1:
                self._left_out(name, "has a second name elsewhere (hard link)")
            else:
                self._write(target, file, executable=bool(status.st_mode & stat.S_IXUSR))

    def _zip(self, archive: zipfile.ZipFile) -> None:
        problem: Exception | None = None
        entries = sorted(archive.infolist(), key=lambda entry: _importance(entry.filename))
        for entry in _first(entries, self):
            try:
                self._zipped(archive, entry)
            except Exception as error:  # noqa: BLE001  (one odd entry is not to cost the others)
                _raise_ours(error)
                problem = problem or error
        if problem:
            raise problem

    def _zipped(self, archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> None:
        mode = entry.external_attr >> 16
        if entry.is_dir():
            return
        if stat.S_IFMT(mode) not in {0, stat.S_IFREG}:
            self._left_out(entry.filename, _kind(mode))
            return
        if entry.flag_bits & 1:
            self._left_out(entry.filename, "is encrypted")
            return
        target = self._target(entry.filename)
        if target is not None:
            with archive.open(entry) as file:
                self._write(target, file, executable=bool(mode & stat.S_IXUSR), unix=mode != 0)

    def _tar(self, archive: tarfile.TarFile) -> None:
        for entry in _first(archive, self):
            if entry.isdir():
                continue
            if not entry.isreg():
                self._left_out(entry.name, "is a link or a device")
                continue
            target = self._target(entry.name)
            file = archive.extractfile(entry)
            if target is not None and file is not None:
                with file:
                    self._write(target, file, executable=bool(entry.mode & stat.S_IXUSR))

    def _target(self, name: str) -> PurePosixPath | None:
        """Give a harmless relative path for an archive's entry, or None."""
        parts = PurePosixPath(name.replace("\\", "/")).parts
        if any(part in _JUNK for part in parts):
            return None
        if name.startswith("/") or ".." in parts or (parts and parts[0].endswith(":")):
            self._left_out(name, "points outside its archive")
            return None
        if not parts or len(parts) > MOST_DEPTH:
            self._left_out(name, "lies too deep")
            return None
        return PurePosixPath(*parts)

    def _write(
        self, target: PurePosixPath, file: IO[bytes], *, executable: bool, unix: bool = True
    ) -> None:
        path = self.into / PurePosixPath(*map(safe_name, target.parts))
        if self._files >= MOST_FILES:
            self._overfull(f"more than {MOST_FILES} files")
            return
        if path.exists() or any(parent.is_file() for parent in path.parents):
            self._left_out(str(target), "has the same name as another file")
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        size, start = 0, b""
        with path.open("xb") as copy:
            while chunk := file.read(_CHUNK):
                start = start or chunk[:2]
                size += len(chunk)
                self._bytes += len(chunk)
                if size > MOST_FILE_BYTES or self._bytes > MOST_BYTES:
                    break
                copy.write(chunk)
        self._files += 1
        if self._bytes > MOST_BYTES:
            path.unlink()
            self._overfull(f"more than {MOST_BYTES // 2**20} MB")
        elif size > MOST_FILE_BYTES:
            path.unlink()
            self._left_out(str(target), f"is larger than {MOST_FILE_BYTES // 2**20} MB")
        elif not unix and start == b"#!":
            # Archives made on Windows know no such bit; a script is meant to run.
            path.chmod(0o755)
            self.notes.append(
                f"{clean(str(target), 100)} was made executable (your archive cannot say so)."
            )
        else:
            path.chmod(0o755 if executable else 0o644)

    def _overfull(self, reason: str) -> None:
        if not self._full:
            self.events.append(f"submission cut off: {reason}")
            self.notes.append(f"Your submission has {reason}; the rest was left out.")
        self._full = True

    def _left_out(self, name: str, reason: str) -> None:
        if len(self.events) < 50:
            self.left_out.append((name, reason))
            self.events.append(f"left out {clean(name, 100)!r}: {reason}")


def _raise_ours(error: Exception) -> None:
    """Raise what is no fault of the file: with a result, its student would lose it for good."""
    if isinstance(error, OSError) and error.errno in _OURS:
        raise error


def _first(entries: Iterable[Any], copier: Copier) -> Iterable[Any]:
    for entry, _ in zip(entries, range(_MOST_ENTRIES), strict=False):
        if copier._full:  # noqa: SLF001
            return
        yield entry


def _importance(name: str) -> tuple[int, str]:
    """Put first what is graded: thousands of files beside it must not keep it from being read."""
    lowered = name.lower()
    graded = (lowered.endswith(".ipynb"), "unit4" in lowered, lowered.endswith(ARCHIVES), True)
    return graded.index(True), name


def safe_name(name: str) -> str:
    """Give a file name without control characters, of reasonable length.

    Parameters
    ----------
    name : str
        One part of a path.

    Returns
    -------
    str
    """
    name = name.encode("utf-8", "replace").decode()
    kept = "".join(c for c in name if unicodedata.category(c)[0] != "C" and c != "/")
    stem, dot, suffix = kept.rpartition(".")
    if len(kept.encode()) > _MOST_NAME:
        short = (stem or kept).encode()[: _MOST_NAME - 20].decode(errors="ignore")
        kept = f"{short}{dot}{suffix[:10]}"
    return kept if kept.strip(". ") else "unnamed"


def _kind(mode: int) -> str:
    names = {
        stat.S_IFLNK: "is a symbolic link",
        stat.S_IFIFO: "is a pipe",
        stat.S_IFSOCK: "is a socket",
        stat.S_IFCHR: "is a device",
        stat.S_IFBLK: "is a device",
    }
    return names.get(stat.S_IFMT(mode), "is not a regular file")


def tree(folder: Path) -> list[Path]:
    """List the regular files of a folder that `Copier` has filled, sorted."""
    return sorted(path for path in folder.rglob("*") if path.is_file())
