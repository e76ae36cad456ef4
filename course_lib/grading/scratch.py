"""Folders for temporary files, and their end."""

from __future__ import annotations

import contextlib
import shutil
import stat
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

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


def remove(folder: Path) -> None:
    """Delete a folder, whatever permissions a submission gave to what is in it."""

    def again(function: Callable[..., Any], path: str, _: object) -> None:
        with contextlib.suppress(OSError):
            for part in (Path(path).parent, Path(path)):
                if stat.S_ISDIR(part.lstat().st_mode):
                    part.chmod(0o700)
            function(path)

    for _ in range(3):
        shutil.rmtree(folder, onerror=again)
        if not folder.exists():
            return
