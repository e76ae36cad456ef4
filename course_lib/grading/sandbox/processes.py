"""
What the system says of processes, read so that a process cannot hide from it.

A process chooses its own name, which need be no text and may hold brackets; and one whose first
thread has ended looks dead while its other threads go on.
"""

from __future__ import annotations

import contextlib
import os
import re
from pathlib import Path

_PARENT, _THREADS = 1, 17  # places in what `fields` gives
_LOWERED = 10  # of 19 steps of niceness: many such processes together still leave time for one
_MEMORY = re.compile(rb"^(?:RssAnon|RssShmem|VmSwap|VmPTE):\s+(\d+)", re.MULTILINE)
_TABLES = re.compile(rb"^VmPTE:\s+(\d+)", re.MULTILINE)
_SHARE = re.compile(rb"^(?:Pss|SwapPss):\s+(\d+)", re.MULTILINE)


def fields(pid: int) -> list[bytes]:
    """Give the fields of ``/proc/PID/stat`` that follow the name, from the state on.

    Raises
    ------
    OSError
        When there is no such process.
    """
    return Path(f"/proc/{pid}/stat").read_bytes().rpartition(b")")[2].split()


def parent(pid: int) -> int:
    """Give a process's parent."""
    return int(fields(pid)[_PARENT])


def everybody() -> list[int]:
    """List all processes that can be seen."""
    return [int(entry.name) for entry in os.scandir("/proc") if entry.name.isdigit()]


def descendants(pid: int) -> list[int]:
    """List the living processes that a process has started, directly or not."""
    children: dict[int, list[int]] = {}
    dead = set()
    for each in everybody():
        with contextlib.suppress(OSError, ValueError, IndexError):
            found = fields(each)
            children.setdefault(int(found[_PARENT]), []).append(each)
            if found[0] in b"ZX" and int(found[_THREADS]) <= 1:
                dead.add(each)
    below, waiting = [], [pid]
    while waiting:
        following = children.get(waiting.pop(), [])
        below += following
        waiting += following
    return [each for each in below if each not in dead]


def threads_of(uid: int) -> int:
    """Count a user's threads."""
    total = 0
    for pid in everybody():
        with contextlib.suppress(OSError, ValueError, IndexError):
            if Path(f"/proc/{pid}").stat().st_uid == uid:
                total += int(fields(pid)[_THREADS])
    return total


def memory(pid: int) -> tuple[int, int]:
    """Say how much memory a process has to itself or shares with others but not with a file.

    Returns
    -------
    total, tables : int
        Bytes: all of it, what is swapped out included; and the system's tables of it.
    """
    data = _status(pid)
    total = sum(map(int, _MEMORY.findall(data)))
    return total * 1024, sum(map(int, _TABLES.findall(data))) * 1024


def share_of_memory(pid: int) -> int | None:
    """Say how much memory a process uses, its share of what several use; None when it hides it.

    Takes the system a while.
    """
    for place in _bodies(pid):
        with contextlib.suppress(OSError):
            return sum(map(int, _SHARE.findall((place / "smaps_rollup").read_bytes()))) * 1024
    return None


def _status(pid: int) -> bytes:
    for place in _bodies(pid):
        with contextlib.suppress(OSError):
            data = (place / "status").read_bytes()
            if b"VmPTE" in data:
                return data
    return b""


def _bodies(pid: int) -> list[Path]:
    """Give the process's own folder; if its first thread has ended, those of its other threads."""
    own = Path(f"/proc/{pid}")
    with contextlib.suppress(OSError, IndexError):
        if fields(pid)[0] in b"ZX":
            return sorted((own / "task").iterdir(), reverse=True)[:100]
    return [own]


def open_files(pid: int) -> dict[tuple[int, int], os.stat_result]:
    """Describe what a process has open, by device and inode; nothing when it hides it."""
    found = {}
    with contextlib.suppress(OSError):
        for entry in os.scandir(f"/proc/{pid}/fd"):
            with contextlib.suppress(OSError):
                status = entry.stat()
                found[status.st_dev, status.st_ino] = status
    return found


def lower(pid: int) -> None:
    """Let others go first, whenever there are any."""
    with contextlib.suppress(OSError):
        for thread in Path(f"/proc/{pid}/task").iterdir():
            with contextlib.suppress(OSError):
                os.setpriority(os.PRIO_PROCESS, int(thread.name), _LOWERED)
    # Where the system shares time between sessions first, the session must be lowered too.
    with contextlib.suppress(OSError):
        Path(f"/proc/{pid}/autogroup").write_text(str(_LOWERED))
