"""
Wall clock and processor time of a command and of everything that it starts.

The processor time is that of a control group made for the command: it counts every process, also
one that was killed, left behind, forked twice or buried by nobody, which `getrusage` does not (a
sandbox's kernel is killed with its container, and the system waits for it itself). Where no control
group can be made, there is no processor time.
"""

from __future__ import annotations

import os
import subprocess
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

ROOT = Path("/sys/fs/cgroup")
PROCESSORS = 2
_TIMEOUT = 1200.0
_LEFT_OVER_SECONDS = 5.0


class CommandError(Exception):
    """A measured command ended badly."""


@dataclass(frozen=True)
class Spent:
    """Seconds: on the wall, and of all processors together (None where nobody can say)."""

    wall: float
    cpu: float | None

    def __add__(self, other: Spent) -> Spent:
        known = self.cpu is not None and other.cpu is not None
        return Spent(self.wall + other.wall, self.cpu + other.cpu if known else None)

    def per(self, count: int) -> Spent:
        return Spent(self.wall / count, None if self.cpu is None else self.cpu / count)


def run(
    command: Sequence[str | Path],
    folder: Path,
    *,
    env: Mapping[str, str] | None = None,
    watch: Callable[[int], None] | None = None,
) -> Spent:
    """
    Run a command on two processors, and measure it.

    Parameters
    ----------
    command : sequence of str or Path
    folder : Path
        Where it runs.
    env : mapping, optional
        Added to the environment.
    watch : callable, optional
        Called with the process id some times a second.

    Raises
    ------
    CommandError
        When its exit status is not 0; with what it printed.
    """
    group = _group()
    processors = sorted(os.sched_getaffinity(0))[:PROCESSORS]

    def enter() -> None:
        os.sched_setaffinity(0, processors)
        if group:
            (group / "cgroup.procs").write_text("0")

    start = time.perf_counter()
    with subprocess.Popen(
        [str(part) for part in command],
        cwd=folder,
        env={**os.environ, **(env or {})},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        preexec_fn=enter,  # noqa: PLW1509  (no thread runs here)
    ) as process:
        try:
            said = _await(process, watch)
        except BaseException:
            _end(group, process)
            raise
    wall = time.perf_counter() - start
    cpu = None
    if group:
        _await_empty(group)
        cpu = _seconds(group)
        _remove(group)
    if process.returncode:
        what = " ".join(map(str, command))
        raise CommandError(f"{what} ended with {process.returncode}:\n{said[-3000:]}")
    return Spent(wall, cpu)


def _await(process: subprocess.Popen[bytes], watch: Callable[[int], None] | None) -> str:
    deadline = time.monotonic() + _TIMEOUT
    while True:
        try:
            left = deadline - time.monotonic()
            said, _ = process.communicate(timeout=max(0.0, min(left, 0.1) if watch else left))
        except subprocess.TimeoutExpired:
            if time.monotonic() > deadline:
                raise CommandError(f"not done after {_TIMEOUT:.0f} s") from None
            if watch:
                watch(process.pid)
        else:
            return said.decode(errors="replace")


def _group() -> Path | None:
    """Make a control group within this process's own; None where that is not allowed."""
    for line in Path("/proc/self/cgroup").read_text().splitlines():
        _, kinds, path = line.split(":", 2)
        if "cpuacct" in kinds.split(","):
            place, file = ROOT / "cpuacct", "cpuacct.usage"
        elif not kinds:
            place, file = ROOT, "cpu.stat"
        else:
            continue
        group = place / path.lstrip("/") / f"bench-{os.getpid()}-{time.monotonic_ns()}"
        with suppress(OSError):
            group.mkdir()
            if (group / file).exists() and os.access(group / "cgroup.procs", os.W_OK):
                return group
            group.rmdir()
    return None


def _seconds(group: Path) -> float:
    if (group / "cpuacct.usage").exists():
        return int((group / "cpuacct.usage").read_text()) / 1e9
    first = (group / "cpu.stat").read_text().split()
    return int(first[first.index("usage_usec") + 1]) / 1e6


def _await_empty(group: Path) -> None:
    """Let what the command left behind end; it works for the same purpose."""
    deadline = time.monotonic() + _LEFT_OVER_SECONDS
    while (group / "cgroup.procs").read_text().strip() and time.monotonic() < deadline:
        time.sleep(0.05)


def _remove(group: Path) -> None:
    for pid in (group / "cgroup.procs").read_text().split():
        with suppress(OSError):
            os.kill(int(pid), 9)
    for _ in range(100):
        try:
            group.rmdir()
        except OSError:
            time.sleep(0.02)
        else:
            return


def _end(group: Path | None, process: subprocess.Popen[bytes]) -> None:
    """End everything that was started."""
    process.terminate()  # ours ends its sandboxes itself
    with suppress(subprocess.TimeoutExpired):
        process.communicate(timeout=20)
    process.kill()
    if group:
        _remove(group)
