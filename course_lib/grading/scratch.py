"""Folders for temporary files, and their end."""

from __future__ import annotations

import contextlib
import itertools
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_LONGEST = 40  # characters: paths of sockets below it must stay under 108


def scratch_folder() -> Path:
    """Make a folder for temporary files, with a path short enough for sockets in it.

    Returns
    -------
    Path
        Students' own users may pass through it, to their working folders.
    """
    base = tempfile.gettempdir()
    short = "/tmp" if len(base) > _LONGEST else base  # noqa: S108
    folder = Path(tempfile.mkdtemp(prefix="course-grade-", dir=short))
    folder.chmod(0o711)
    return folder


@contextlib.contextmanager
def working_folder() -> Iterator[Path]:
    """Give a folder for one submission, and delete it, whatever it then holds.

    Yields
    ------
    Path
        Students' own users may pass through it, to their working folders.
    """
    folder = Path(tempfile.mkdtemp(prefix="grade-"))
    folder.chmod(0o711)
    try:
        yield folder
    finally:
        remove(folder)


def remove(folder: Path) -> None:
    """Delete a folder, whatever permissions a submission gave to what is in it, however deep it is.

    A folder in a folder is first moved to the top, so neither the depth of a program's calls nor
    the length of a path sets a limit. Links are deleted, not followed.

    Parameters
    ----------
    folder : Path
        It may be gone already. Nobody else writes there any more.
    """
    with contextlib.suppress(OSError):
        top = _open(folder.name, os.open(folder.parent, os.O_RDONLY | os.O_DIRECTORY))
        try:
            _empty(top)
        finally:
            os.close(top)
    with contextlib.suppress(OSError):
        folder.rmdir()


def _empty(top: int) -> None:
    """Delete what is in an open folder."""
    names = itertools.count()
    stuck: set[str] = set()
    while waiting := [name for name in os.listdir(top) if name not in stuck]:
        for name in waiting:
            if _unlink(name, top) or _unlink_folder(name, top):
                continue
            try:
                inside = _open(name, os.dup(top))
            except OSError:
                stuck.add(name)
                continue
            try:
                for each in os.listdir(inside):  # noqa: PTH208  (by descriptor)
                    if not (_unlink(each, inside) or _unlink_folder(each, inside)):
                        _lift(each, inside, top, names)
            finally:
                os.close(inside)
            if not _unlink_folder(name, top):
                stuck.add(name)


def _unlink(name: str, parent: int) -> bool:
    """Delete a file; tell whether that was possible."""
    try:
        os.unlink(name, dir_fd=parent)
    except OSError:
        return False
    return True


def _unlink_folder(name: str, parent: int) -> bool:
    """Delete an empty folder; tell whether that was possible."""
    try:
        os.rmdir(name, dir_fd=parent)
    except OSError:
        return False
    return True


def _lift(name: str, parent: int, top: int, names: Iterator[int]) -> None:
    """Move a folder up, and make sure that it can be."""
    with contextlib.suppress(OSError):
        os.chmod(name, 0o700, dir_fd=parent)  # a folder can be moved by who may write to it
        for number in names:
            new = f".removed-{number}"
            if not _exists(new, top):
                os.rename(name, new, src_dir_fd=parent, dst_dir_fd=top)
                return


def _exists(name: str, parent: int) -> bool:
    try:
        os.stat(name, dir_fd=parent, follow_symlinks=False)
    except OSError:
        return False
    return True


def _open(name: str, parent: int) -> int:
    """Open a folder with all permissions on it; `parent` is closed."""
    flags = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW
    try:
        try:
            descriptor = os.open(name, flags, dir_fd=parent)
        except PermissionError:
            os.chmod(name, 0o700, dir_fd=parent)
            descriptor = os.open(name, flags, dir_fd=parent)
    finally:
        os.close(parent)
    with contextlib.suppress(OSError):
        os.fchmod(descriptor, 0o700)
    return descriptor
