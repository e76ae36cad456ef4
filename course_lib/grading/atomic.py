"""Writes a file whole or not at all, so that a killed run leaves nothing half-written."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@contextmanager
def replacing(path: Path) -> Iterator[BinaryIO]:
    """Open a file for writing that takes `path`'s place at the end of the block.

    When the block raises, `path` stays as it was. The file is on the disk before it takes its
    place; one writer at a time.

    Parameters
    ----------
    path : Path
        In a folder that exists.
    """
    # Always the same name: what a killed run left behind is taken away by the next. A name of its
    # own length would not fit a folder whose names are near the file system's limit.
    part = path.with_name(f".{path.suffix.lstrip('.')}.part")
    try:
        with part.open("wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def write(path: Path, content: bytes) -> None:
    """Write a file, making its folder if need be."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as file:
        file.write(content)
