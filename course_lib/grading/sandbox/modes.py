"""
Changes the modes and times of a submission's files for it, and of no others.

Landlock has no rule for these. Where the student's processes run under the grader's own user id
they could lock whatever is the grader's: the tests, the submissions, the interpreter. So they ask
(`forks`), and their keeper does it, to the very file that it has opened and looked at.
"""

from __future__ import annotations

import ctypes
import errno
import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

CALLS = {
    "x86_64": {90: "chmod", 91: "fchmod", 268: "fchmodat", 452: "fchmodat2", 280: "utimensat"},
    "aarch64": {52: "fchmod", 53: "fchmodat", 452: "fchmodat2", 88: "utimensat"},
}
_HERE, _NO_FOLLOW, _EMPTY_PATH = -100, 0x100, 0x1000  # AT_FDCWD and two flags
_PERMISSIONS = 0o1777  # a program of the student's is never to run as the grader
_LONGEST = 4096
_TIMES = 32  # bytes: two of seconds and nanoseconds
_libc = ctypes.CDLL(None, use_errno=True)


class Modes:
    """Does what a submission's processes ask for.

    Parameters
    ----------
    folders : sequence of str
        All that is below them is the submission's own.
    """

    def __init__(self, folders: Sequence[str]) -> None:
        self._folders = [os.path.realpath(folder) for folder in folders]

    def change(
        self, call: str, pid: int, arguments: Sequence[int], still_asks: Callable[[], None]
    ) -> None:
        """Do one call in the place of who asks.

        Parameters
        ----------
        call : str
            One of `CALLS`.
        pid : int
            Who asks.
        arguments : sequence of int
            The call's, as the system was given them.
        still_asks : callable
            Raises `OSError` if who asked is gone: the number may be another's by now.

        Raises
        ------
        OSError
            What the asking process is to see.
        """
        if call == "chmod":
            arguments = (_HERE, *arguments)
        elif call == "fchmod":
            arguments = (arguments[0], 0, *arguments[1:])
        folder, name, value, flags = arguments[:4]
        if call in {"chmod", "fchmod", "fchmodat"}:
            flags = 0
        found = _opened(pid, folder, name, flags)
        try:
            times = _memory(pid, value, _TIMES) if call == "utimensat" and value else None
            still_asks()
            path = f"/proc/self/fd/{found}"
            self._check(str(Path(path).readlink()))
            if call != "utimensat":
                Path(path).chmod(value & _PERMISSIONS)
            elif _libc.utimensat(_HERE, path.encode(), times, 0):
                raise OSError(ctypes.get_errno(), "cannot change the times")
        finally:
            os.close(found)

    def _check(self, path: str) -> None:
        if not any(path == own or path.startswith(f"{own}/") for own in self._folders):
            raise OSError(errno.EPERM, "not the submission's own")


def _opened(pid: int, folder: int, name: int, flags: int) -> int:
    """Open what a process means by a folder's descriptor and the address of a name."""
    number = ctypes.c_int(folder & 0xFFFFFFFF).value
    place = f"/proc/{pid}/cwd" if number == _HERE else f"/proc/{pid}/fd/{number}"
    path = _memory(pid, name, _LONGEST).partition(b"\0")[0] if name else b""
    if name and not path and not flags & _EMPTY_PATH:
        raise OSError(errno.ENOENT, "no name")
    follow = os.O_NOFOLLOW if flags & _NO_FOLLOW else 0
    if path.startswith(b"/"):
        return os.open(path, os.O_PATH | follow)
    base = os.open(place, os.O_PATH)
    if not path:
        return base
    try:
        return os.open(path, os.O_PATH | follow, dir_fd=base)
    finally:
        os.close(base)


def _memory(pid: int, address: int, size: int) -> bytes:
    if address >= 1 << 63:
        raise OSError(errno.EFAULT, "no such address")
    descriptor = os.open(f"/proc/{pid}/mem", os.O_RDONLY)
    try:
        data = os.pread(descriptor, size, address)
    finally:
        os.close(descriptor)
    if size == _TIMES and len(data) < size:
        raise OSError(errno.EFAULT, "no such address")
    return data
