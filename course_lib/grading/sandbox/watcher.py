"""Watches what the processes of one submission use together, and ends them when it is too much."""

from __future__ import annotations

import contextlib
import os
import threading
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_lib.grading.sandbox.limits import Limits

_TICK = os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")
_SECONDS_BETWEEN = 0.1
_ROUNDS_PER_DISK = 5  # walking the folder costs more than reading /proc
_GRACE = 8  # processes: short-lived threads of the kernel's own


class Watcher(threading.Thread):
    """Looks ten times a second.

    Parameters
    ----------
    pids : callable
        Lists the submission's processes.
    folder : Path
        Where it may write.
    limits : Limits
    end : callable
        Called once, with the limit that was exceeded, in words.
    """

    def __init__(
        self,
        pids: Callable[[], list[int]],
        folder: Path,
        limits: Limits,
        end: Callable[[str], None],
    ) -> None:
        super().__init__(daemon=True, name="watcher")
        self._pids = pids
        self._folder = folder
        self._limits = limits
        self._end = end
        self._done = threading.Event()
        self._cpu: dict[int, float] = {}
        self._private_start: int | None = None

    def stop(self) -> None:
        """Look no more."""
        self._done.set()

    def run(self) -> None:
        """Look until something is exceeded, or `stop`."""
        rounds = 0
        while not self._done.wait(_SECONDS_BETWEEN):
            rounds += 1
            excess = self._excess(self._pids())
            if not excess and rounds % _ROUNDS_PER_DISK == 0:
                excess = self._disk_excess()
            if excess and not self._done.is_set():
                self._end(excess)
                return

    def _excess(self, pids: list[int]) -> str | None:
        limits = self._limits
        threads = roughly = 0
        for pid in pids:
            with contextlib.suppress(OSError, ValueError, IndexError):
                fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
                self._cpu[pid] = (int(fields[11]) + int(fields[12])) / _TICK
                threads += int(fields[17])
                resident, shared = Path(f"/proc/{pid}/statm").read_text().split()[1:3]
                roughly += (int(resident) - int(shared)) * _PAGE
        if sum(self._cpu.values()) > limits.cpu_s:
            return f"processor limit of {limits.cpu_s:.0f} s"
        if threads > limits.processes + _GRACE:
            return f"limit of {limits.processes} processes"
        # Pages shared since the fork are counted once only if need be: that takes longer.
        if roughly > limits.memory_bytes and sum(map(_proportional, pids)) > limits.memory_bytes:
            return f"memory limit of {limits.memory_bytes / 2**30:.1f} GiB"
        return None

    def _disk_excess(self) -> str | None:
        total = files = 0
        for folder, _, names in os.walk(self._folder):
            for name in names:
                with contextlib.suppress(OSError):
                    total += os.lstat(os.path.join(folder, name)).st_blocks * 512  # noqa: PTH118
            files += len(names)
            if total > self._limits.disk_bytes or files > 20_000:
                return f"disk limit of {self._limits.disk_bytes // 2**20} MiB"
        return None


def _proportional(pid: int) -> int:
    with contextlib.suppress(OSError):
        for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
            if line.startswith("Pss:"):
                return int(line.split()[1]) * 1024
    return 0
