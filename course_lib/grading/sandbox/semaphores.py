"""
Semaphores for `multiprocessing` where the system's cannot be made.

The system keeps them as files in /dev/shm, which all submissions would share, so Landlock closes
it. Without semaphores there is neither a Lock nor a Pool, and honest work would fail in one sandbox
that runs in the other. A pipe does what is needed between a process and its forked children.
"""

from __future__ import annotations

import _multiprocessing  # type: ignore[import-not-found]
import fcntl
import os
import select
import sys
import termios
import threading
import time
from multiprocessing import synchronize

# What Queue means by "as many as you like"; a pipe could not hold so many bytes.
_UNLIMITED = 10_000
_RECURSIVE_MUTEX = 0


def make_do_without_shared_memory() -> None:
    """Let `multiprocessing` use pipes, if it cannot have the system's semaphores."""
    try:
        _multiprocessing.SemLock(1, 1, 1, f"/course-{os.getpid()}", True)  # noqa: FBT003
    except OSError:
        synchronize._multiprocessing = _Substitute  # type: ignore[attr-defined]  # noqa: SLF001


class _PipeLock:
    """Stands in for `_multiprocessing.SemLock`: a byte in the pipe for each free place."""

    def __init__(self, kind: int, value: int, maxvalue: int, name: str, unlink: bool) -> None:  # noqa: FBT001, ARG002
        # Without a name there is nothing to clear away.
        self.kind, self.maxvalue, self.name, self.handle = kind, maxvalue, None, 0
        self._unlimited = value > _UNLIMITED
        self._read, self._write = os.pipe()
        os.set_blocking(self._read, False)
        os.write(self._write, b"." * (0 if self._unlimited else value))
        self._held, self._owner = 0, 0

    def __del__(self) -> None:
        os.close(self._read)
        os.close(self._write)

    def acquire(self, block: bool = True, timeout: float | None = None) -> bool:  # noqa: FBT001, FBT002
        """Take a place; tell whether there was one in time."""
        again = self.kind == _RECURSIVE_MUTEX and self._is_mine()
        if not (again or self._unlimited or self._take(block, timeout)):
            return False
        self._held, self._owner = self._held + 1, threading.get_ident()
        return True

    def _take(self, block: bool, timeout: float | None) -> bool:  # noqa: FBT001
        end = None if timeout is None else time.monotonic() + max(0.0, timeout)
        waiting = select.poll()
        waiting.register(self._read, select.POLLIN)
        while True:
            try:
                return bool(os.read(self._read, 1))
            except BlockingIOError:
                left = None if end is None else end - time.monotonic()
                if not block or (left is not None and left <= 0):
                    return False
                waiting.poll(None if left is None else left * 1000)

    def release(self) -> None:
        """Give a place back."""
        if self.kind == _RECURSIVE_MUTEX:
            if not self._is_mine():
                raise AssertionError("attempt to release recursive lock not owned by thread")
            if self._held > 1:
                self._held -= 1
                return
        elif not self._unlimited and self._get_value() >= self.maxvalue:
            raise ValueError("semaphore or lock released too many times")
        self._held -= 1
        if not self._unlimited:
            os.write(self._write, b".")

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()

    def _count(self) -> int:
        return self._held

    def _is_mine(self) -> bool:
        return self._held > 0 and self._owner == threading.get_ident()

    def _get_value(self) -> int:
        if self._unlimited:
            return self.maxvalue
        free = bytearray(4)
        fcntl.ioctl(self._read, termios.FIONREAD, free)
        return int.from_bytes(free, sys.byteorder)

    def _is_zero(self) -> bool:
        return self._get_value() == 0

    def _after_fork(self) -> None:
        self._held = 0


class _Substitute:
    """Stands in for the module `_multiprocessing` where semaphores are made of it."""

    SemLock = _PipeLock
    sem_unlink = staticmethod(lambda _name: None)
