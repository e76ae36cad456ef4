"""Two workers side by side: one grades what is hostile, the other what is right, again and again.

Everything on the way is real: intake, fingerprints, the worker, its children, the sandbox, reports.
"""

from __future__ import annotations

import importlib.util
import json
import os
import selectors
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Self

from course_lib.grading import report
from course_lib.grading.fingerprint import Fingerprints
from course_lib.grading.messages import Settings, Task
from course_lib.grading.process import WorkerProcess
from course_lib.grading.runner import _write
from course_lib.grading.sandbox import processes
from course_lib.grading.scratch import remove, scratch_folder
from course_lib.grading.submission import find_submissions

if TYPE_CHECKING:
    from collections.abc import Iterable

    from course_lib.grading.messages import Finished
    from course_lib.grading.sandbox import Limits

HERE = Path(__file__).parent
# What must never come out: it is in the seed, the workers' environment and a neighbour's file.
CANARY = "canary-" + "kuckuck"
SHARED = ("/dev/shm", "/dev/mqueue")  # noqa: S108
SEED = f"{CANARY}: the secret of these tests".encode()


def builder():
    """Import `samples/build.py`."""
    spec = importlib.util.spec_from_file_location("build", HERE / "samples" / "build.py")
    module = sys.modules["build"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@dataclass
class Graded:
    """What came of one submission, and of the neighbour meanwhile."""

    finished: Finished
    seconds: float
    told: dict
    pages: str  # what was written about it, for the student and the instructor
    neighbours: list[tuple[float, float, float]] = field(
        default_factory=list
    )  # points, of, seconds
    left: set[str] = field(default_factory=set)


class Desk:
    """The two workers of one sandbox and one folder of hidden tests."""

    def __init__(self, sandbox: str, limits: Limits, tests: Path, neighbour: Path) -> None:
        self.settings = Settings(
            SEED, tests, ("4.1", "4.2"), sandbox=sandbox, limits=limits, grace_s=30
        )
        self._neighbour = neighbour
        self._scratch = scratch_folder()
        self._out = self._scratch.with_name(f"{self._scratch.name}.out")

    def __enter__(self) -> Self:
        os.environ["COURSE_CANARY"] = CANARY
        names = ("hostile", "neighbour")
        self._workers = [WorkerProcess(self.settings, self._scratch / name) for name in names]
        for worker in self._workers:
            assert worker.answer() is None
        self._fingerprints = Fingerprints(self.settings)
        self.alone = [self._one(self._workers[1], self._neighbour) for _ in range(2)][-1][1]
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            worker.close()
        remove(self._scratch)
        remove(self._out)
        os.environ.pop("COURSE_CANARY", None)

    def _begin(self, worker: WorkerProcess, root: Path) -> Task:
        (source,) = find_submissions(root)
        task = Task(source.student, source.paths, self._fingerprints(source.paths))
        worker.begin(task)
        return task

    def _one(self, worker: WorkerProcess, root: Path) -> tuple[Finished, float]:
        start = time.monotonic()
        self._begin(worker, root)
        return worker.answer(), time.monotonic() - start

    def grade(self, root: Path) -> Graded:
        """Grade the one submission in a folder, the neighbour beside it while that takes."""
        hostile, neighbour = self._workers
        before = leftovers(self._scratch)
        started = time.monotonic()
        self._begin(hostile, root)
        beside, neighbours, finished = None, [], None
        with selectors.DefaultSelector() as selector:
            for worker in self._workers:
                selector.register(worker, selectors.EVENT_READ)
            while finished is None or beside is not None:
                if beside is None:
                    beside = time.monotonic()
                    self._begin(neighbour, self._neighbour)
                for key, _ in selector.select():
                    answer = key.fileobj.answer()
                    if key.fileobj is hostile:
                        finished, seconds = answer, time.monotonic() - started
                    else:
                        result = answer.result
                        took = time.monotonic() - beside
                        neighbours.append((result.score, result.max_score, took))
                        beside = None
        written = _write(self._out, finished)
        folder = report.student_folder(self._out, finished.result.student)
        return Graded(
            written,
            seconds,
            json.loads((folder / "results.json").read_text()),
            _joined(folder.glob("*.html"), self._out.glob(f"_instructor/{folder.name}/*.html")),
            neighbours,
            leftovers(self._scratch) - before,
        )


def _joined(*paths: Iterable[Path]) -> str:
    return "".join(p.read_text(errors="replace") for some in paths for p in some)


def leftovers(scratch: Path) -> set[str]:
    """List what a submission could leave: processes, sockets, shared memory, mounts, files.

    What other programs do on this machine is not looked at: processes count that descend from this
    one (a worker adopts what loses its parent), sockets and mounts below the workers' folders.
    """
    found = {f"process {pid}" for pid in processes.descendants(os.getpid())}
    for table in ("shm", "msg", "sem"):
        for line in Path(f"/proc/sysvipc/{table}").read_text().splitlines()[1:]:
            found.add(f"System V {table} {line.split()[0]}")
    found |= {f"file {path}" for folder in SHARED for path in _list(folder)}
    for table in ("/proc/net/unix", "/proc/mounts"):
        lines = Path(table).read_text(errors="replace").splitlines()
        found |= {f"{table} {line}" for line in lines if str(scratch) in line}
    return found | {str(path) for path in scratch.glob("*/*")}


def _list(folder: str) -> list[str]:
    return [str(path) for path in Path(folder).glob("*left*")]
