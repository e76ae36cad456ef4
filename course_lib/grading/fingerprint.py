"""Tells whether a submission was graded before, in the same way: then nothing is to be done."""

from __future__ import annotations

import hashlib
import os
import platform
import stat
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

import course_lib

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from course_lib.grading.messages import Settings

_MOST_FILE = 64 * 2**20  # bytes of one file that are read; beyond, its size and date must do
_MOST_BYTES = 256 * 2**20
_MOST_ENTRIES = 20_000
_MOST_DEPTH = 40
# What can change a result without any line of ours changing.
_LIBRARIES = (
    *("numpy", "opencv-contrib-python-headless", "matplotlib", "ipykernel", "ipython", "nbformat"),
    *("jupyter-client", "nbval", "pytest", "rosbags", "pillow", "sandlock", "scikit-learn"),
)
_OUR_KINDS = (".py", ".j2", ".css", ".js", ".json", ".png", ".jpg", ".bag", ".npz")


class Fingerprints:
    """Makes fingerprints of submissions; the way they are graded is part of them.

    They are keyed with the secret: students see them and learn nothing about it.

    Parameters
    ----------
    settings : Settings
        How submissions are graded.
    """

    def __init__(self, settings: Settings) -> None:
        # A secret that a person made up must not be found by trying words.
        self._key = hashlib.scrypt(
            settings.seed, salt=b"course fingerprint", n=2**14, r=8, p=1, dklen=32
        )
        shared = hashlib.blake2b(key=self._key)
        way = (settings.exercises, settings.sandbox, asdict(settings.limits), settings.grade)
        for part in (*way, settings.ros):
            _add(shared, repr(part).encode())
        _add(shared, library().encode())
        for name, line in _lines(settings.tests):
            if "__pycache__" not in name:
                _add(shared, line)
        self._shared = shared.digest()

    def __call__(self, paths: Iterable[Path]) -> str:
        """Give the fingerprint of a submission's files, as they are now.

        Parameters
        ----------
        paths : iterable of Path
            As in `submission.Source`. Links are not followed, and floods not read to their end.
        """
        own = hashlib.blake2b(self._shared, key=self._key, digest_size=16)
        for path in paths:
            _add(own, os.fsencode(path.name))
            for _, line in _lines(path):
                _add(own, line)
        return own.hexdigest()


def library() -> str:
    """Give a hash of the course's code, its pictures, and the libraries it uses.

    Returns
    -------
    str
        The same on every machine with the same.
    """
    found = hashlib.blake2b(digest_size=16)
    _add(found, platform.python_version().encode())
    for name in _LIBRARIES:
        try:
            _add(found, f"{name} {metadata.version(name)}".encode())
        except metadata.PackageNotFoundError:
            _add(found, name.encode())
    root = Path(course_lib.__file__).resolve().parent
    for folder in (root, root.parent / "images"):
        for name, line in _lines(folder, most=1 << 40):
            if name.endswith(_OUR_KINDS) and "/render/" not in name:
                _add(found, line)
    return found.hexdigest()


def _add(into: hashlib.blake2b, part: bytes) -> None:
    into.update(len(part).to_bytes(8, "big") + part)


def _lines(path: Path, most: int = _MOST_BYTES) -> Iterator[tuple[str, bytes]]:
    """Describe a file or all files of a folder, sorted: name, kind, mode, content."""
    left = [most, _MOST_ENTRIES]
    yield from _walk(path, "", left, 0)


def _walk(path: Path, name: str, left: list[int], depth: int) -> Iterator[tuple[str, bytes]]:
    left[1] -= 1
    if left[1] < 0 or depth > _MOST_DEPTH:
        return
    try:
        status = path.lstat()
        if stat.S_ISDIR(status.st_mode):
            with os.scandir(path) as entries:
                names = sorted(
                    entry.name for entry, _ in zip(entries, range(left[1]), strict=False)
                )
            yield name, os.fsencode(name) + b"/"
            for child in names:
                yield from _walk(path / child, f"{name}/{child}", left, depth + 1)
            return
        content = _content(path, status, left)
    except OSError as error:
        content = f"unreadable {error.errno}".encode()
        status = None
    mode = oct(status.st_mode & 0o170111) if status else ""
    yield name, os.fsencode(name) + f"\0{mode}\0".encode() + content


def _content(path: Path, status: os.stat_result, left: list[int]) -> bytes:
    if stat.S_ISLNK(status.st_mode):
        return os.fsencode(path.readlink())
    if not stat.S_ISREG(status.st_mode):
        return b"special"
    size = status.st_size
    if size > min(_MOST_FILE, left[0]):
        return f"{size} bytes of {status.st_mtime_ns}".encode()
    # Exchanged since: a link is not followed, a pipe not waited for.
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    with os.fdopen(descriptor, "rb") as file:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            return b"special"
        content = file.read(size + 1)
    left[0] -= len(content)
    return hashlib.blake2b(content).digest() + f"\0{status.st_nlink > 1}".encode()
