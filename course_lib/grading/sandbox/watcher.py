"""Watches what the processes of one submission use together, and ends them when it is too much."""

from __future__ import annotations

import contextlib
import os
import stat
import threading
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.grading.sandbox import processes

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_lib.grading.sandbox.limits import Limits

_TICK = os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")
_SECONDS_BETWEEN = 0.1
_ROUNDS_PER_DISK = 5  # walking the folder costs more than reading /proc
_GRACE = 8  # processes: short-lived threads of the kernel's own
_MOST_FILES = 5_000
_MOST_DEPTH = 100  # folders; a path of theirs is still short enough to be used
_MOST_CONNECTIONS = 1024  # sockets and pipes hold memory of the system's that nobody is billed for
_MOST_SENT = 3 * 2**29  # bytes that this process may grow by: what it is sent must fit
_GREEDY_PROCESSORS = 1.5
_GREEDY_ROUNDS = 4


class Watcher(threading.Thread):
    """Looks ten times a second.

    Parameters
    ----------
    pids : callable
        Lists the submission's processes.
    folders : sequence of Path
        Where it may write.
    in_memory : callable
        Lists the places in memory where it may write.
    limits : Limits
    end : callable
        Called once, with the limit that was exceeded, in words.
    """

    def __init__(
        self,
        pids: Callable[[], list[int]],
        folders: Sequence[Path],
        in_memory: Callable[[], list[str]],
        limits: Limits,
        end: Callable[[str], None],
    ) -> None:
        super().__init__(daemon=True, name="watcher")
        self._pids = pids
        self._folders = folders
        self._in_memory = in_memory
        self._limits = limits
        self._end = end
        self._done = threading.Event()
        self._cpu: dict[int, float] = {}
        self._used: deque[float] = deque([0.0], maxlen=_GREEDY_ROUNDS + 1)
        self._at_first = _own_memory()

    def stop(self) -> None:
        """Look no more."""
        self._done.set()

    def run(self) -> None:
        """Look until something is exceeded, or `stop`."""
        rounds = 0
        while not self._done.wait(_SECONDS_BETWEEN):
            rounds += 1
            try:
                excess = self._look(disk=rounds % _ROUNDS_PER_DISK == 0)
            except Exception as error:  # noqa: BLE001  (what cannot be watched must not go on)
                excess = f"the watcher failed: {type(error).__name__}"
            if excess and not self._done.is_set():
                self._end(excess)
                return

    def _look(self, *, disk: bool) -> str | None:
        pids = self._pids()
        excess = self._excess(pids)
        if not excess and disk:
            excess = self._disk_excess(pids)
        return excess

    def _excess(self, pids: list[int]) -> str | None:
        limits = self._limits
        threads = roughly = tables = 0
        waited_for = 0.0
        for pid in pids:
            with contextlib.suppress(OSError, ValueError, IndexError):
                user, system, *of_children = map(int, processes.fields(pid)[11:15])
                self._cpu[pid] = (user + system) / _TICK
                waited_for += (user + system + sum(of_children)) / _TICK
                threads += int(processes.fields(pid)[17])
                total, own_tables = processes.memory(pid)
                roughly += total
                tables += own_tables
        used = max(sum(self._cpu.values()), waited_for)
        self._be_fair(pids, used)
        if used > limits.cpu_s:
            return f"processor limit of {limits.cpu_s:.0f} s"
        if threads > limits.processes + _GRACE:
            return f"limit of {limits.processes} processes"
        if roughly > limits.memory_bytes and (
            tables > limits.memory_bytes or self._memory(pids) > limits.memory_bytes
        ):
            return f"memory limit of {limits.memory_bytes / 2**30:.1f} GiB"
        if _own_memory() - self._at_first > _MOST_SENT:
            return "sent the grader more than it can take"
        return None

    @staticmethod
    def _memory(pids: list[int]) -> int:
        # Pages shared since the fork are counted once only if need be: that takes longer.
        total = 0
        for pid in pids:
            share = processes.share_of_memory(pid)
            total += processes.memory(pid)[0] if share is None else share
        return total

    def _be_fair(self, pids: list[int], used: float) -> None:
        """Let the neighbours go first when this submission takes more than its one processor."""
        self._used.append(used)
        seconds = _SECONDS_BETWEEN * _GREEDY_ROUNDS
        if used - self._used[0] > _GREEDY_PROCESSORS * seconds and len(pids) > 1:
            for pid in pids:
                processes.lower(pid)

    def _disk_excess(self, pids: list[int]) -> str | None:
        total = files = 0
        for folder in self._folders:
            size, number, deep = _usage(folder, _MOST_FILES - files)
            total += size
            files += number
            if deep:
                return f"disk limit of {_MOST_DEPTH} folders in each other"
        for place in self._in_memory():
            with contextlib.suppress(OSError):
                status = os.statvfs(place)
                total += (status.f_blocks - status.f_bfree) * status.f_frsize
                files += status.f_files - status.f_ffree
        opened = {key: each for pid in pids for key, each in processes.open_files(pid).items()}
        devices = {folder.stat().st_dev for folder in self._folders if folder.exists()}
        for each in opened.values():
            if stat.S_ISREG(each.st_mode) and not each.st_nlink and each.st_dev in devices:
                total += each.st_blocks * 512  # its name is gone, its bytes are not
        if total > self._limits.disk_bytes or files >= _MOST_FILES:
            return f"disk limit of {self._limits.disk_bytes // 2**20} MiB"
        ends = sum(stat.S_ISSOCK(s.st_mode) or stat.S_ISFIFO(s.st_mode) for s in opened.values())
        if ends > _MOST_CONNECTIONS:
            return f"limit of {_MOST_CONNECTIONS} sockets and pipes"
        return None


def _usage(folder: Path, most: int) -> tuple[int, int, bool]:
    """Give bytes and number of the files below a folder, at most so many, and if it is too deep."""
    total = files = 0
    waiting = [(str(folder), 0)]
    while waiting and files < most:
        path, depth = waiting.pop()
        if depth > _MOST_DEPTH:
            return total, files, True
        with contextlib.suppress(OSError), os.scandir(path) as entries:
            for entry in entries:
                files += 1
                with contextlib.suppress(OSError):
                    total += entry.stat(follow_symlinks=False).st_blocks * 512
                if entry.is_dir(follow_symlinks=False):
                    waiting.append((entry.path, depth + 1))
                if files >= most:
                    break
    return total, files, False


def _own_memory() -> int:
    return int(Path("/proc/self/statm").read_bytes().split()[1]) * _PAGE
