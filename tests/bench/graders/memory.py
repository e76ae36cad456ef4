"""
Peak memory of a running grader, by role: the grader itself, its workers, what forks the kernels.

Read from `/proc` ten times a second: `VmHWM`, the most that a process ever held resident, so
looking now and then misses no peak of a process that lives as long as the run.
"""

from __future__ import annotations

import os
from collections import defaultdict
from contextlib import suppress
from pathlib import Path

ROLES = ("grader", "worker", "zygote")


class Peaks:
    """Remembers the highest peak of each role, in MiB; give `look` to `usage.run`.

    Attributes
    ----------
    mib : dict of str to float
        By role; of several workers, the largest.
    """

    def __init__(self) -> None:
        self.mib = dict.fromkeys(ROLES, 0.0)

    def look(self, grader: int) -> None:
        children = _children()
        self._note("grader", grader)
        nurseries = [pid for pid in children[grader] if _is(pid, "nursery")]
        for worker in (pid for nursery in nurseries for pid in children[nursery]):
            self._note("worker", worker)
            for pid in children[worker]:
                if _is(pid, "zygote"):
                    self._note("zygote", pid)

    def _note(self, role: str, pid: int) -> None:
        with suppress(OSError, IndexError, ValueError):
            text = Path(f"/proc/{pid}/status").read_text()
            peak = int(text.partition("VmHWM:")[2].split()[0]) / 1024
            self.mib[role] = max(self.mib[role], peak)


def _children() -> dict[int, list[int]]:
    found: dict[int, list[int]] = defaultdict(list)
    for name in os.listdir("/proc"):  # noqa: PTH208  (often: no paths)
        if name.isdigit():
            with suppress(OSError, IndexError, ValueError):
                fields = Path(f"/proc/{name}/stat").read_text().rpartition(")")[2].split()
                found[int(fields[1])].append(int(name))
    return found


def _is(pid: int, name: str) -> bool:
    with suppress(OSError):
        return Path(f"/proc/{pid}/comm").read_text().strip() == name
    return False
