"""Reads what a compressed file holds, up to a limit: a few bytes may stand for any number."""

from __future__ import annotations

import bz2
import gzip
import io
import lzma
from typing import IO, TYPE_CHECKING, cast

if TYPE_CHECKING:
    from pathlib import Path

MOST_BYTES = 512 * 2**20  # more than is kept: archives hold what is left out, too
_STEP = 1 << 20


class TooLargeError(ValueError):
    """It holds more than anybody hands in."""


class Limited(io.RawIOBase):
    """A stream that is read forwards, and only so far; skipping counts as reading.

    Parameters
    ----------
    stream : binary file
    most : int, optional
        Bytes.
    """

    def __init__(self, stream: IO[bytes], most: int = MOST_BYTES) -> None:
        self._stream = stream
        self._most = most
        self._at = 0

    def readable(self) -> bool:
        """Tell that it can be read."""
        return True

    def seekable(self) -> bool:
        """Tell that it can be skipped in."""
        return True

    def tell(self) -> int:
        """Give the position."""
        return self._at

    def read(self, size: int = -1) -> bytes:
        """Read some bytes.

        Raises
        ------
        TooLargeError
            Beyond the limit, before anything is read.
        """
        if size < 0 or self._at + size > self._most:
            raise TooLargeError(f"it holds more than {self._most // 2**20} MB")
        data = self._stream.read(size)
        self._at += len(data)
        return data

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Go forwards by reading, or back to what was just read."""
        target = self._at + offset if whence == io.SEEK_CUR else offset
        if whence == io.SEEK_END or target < self._at:
            self._stream.seek(target)
            self._at = target
        while self._at < target and self.read(min(_STEP, target - self._at)):
            pass
        return self._at

    def close(self) -> None:
        """Close the file."""
        self._stream.close()
        super().close()


def unpacked(path: Path) -> Limited:
    """Open a file that may be compressed.

    Parameters
    ----------
    path : Path
        Plain, or packed by gzip, bzip2 or xz: what it begins with tells.

    Returns
    -------
    Limited
    """
    with path.open("rb") as file:
        start = file.read(6)
    if start[:2] == b"\x1f\x8b":
        return Limited(cast("IO[bytes]", gzip.open(path)))
    if start[:3] == b"BZh":
        return Limited(bz2.open(path))
    if start == b"\xfd7zXZ\0":
        return Limited(lzma.open(path))
    return Limited(path.open("rb"))
