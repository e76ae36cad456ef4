"""Workers side by side: some grade what is hostile, one what is right, again and again.

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
from course_lib.grading.nursery import Nursery
from course_lib.grading.process import WorkerProcess
from course_lib.grading.runner import _write
from course_lib.grading.sandbox import processes
from course_lib.grading.sandbox.limits import Limits
from course_lib.grading.scratch import remove, scratch_folder
from course_lib.grading.submission import find_submissions

if TYPE_CHECKING:
    from collections.abc import Iterable

    from course_lib.grading.messages import Finished

HERE = Path(__file__).parent
QUICK = HERE / "quick_hidden"
# What must never come out: it is in the seed, the workers' environment and a neighbour's file.
CANARY = "canary-" + "kuckuck"
SHARED = ("/dev/shm", "/dev/mqueue")  # noqa: S108
SEED = f"{CANARY}: the secret of these tests".encode()
_LONGEST_S = 250.0


def builder():
    """Import `samples/build.py`."""
    spec = importlib.util.spec_from_file_location("build", HERE / "samples" / "build.py")
    module = sys.modules["build"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@dataclass
class Beside:
    """A grading of the neighbour, which may last longer than the sample that it began beside.

    Attributes
    ----------
    samples : list of str
        Those that were graded meanwhile.
    reached, possible, seconds : float or None
        What came of it; None while it lasts.
    """

    samples: list[str]
    reached: float | None = None
    possible: float | None = None
    seconds: float | None = None


@dataclass
class Graded:
    """What came of one submission, and of the neighbour meanwhile."""

    finished: Finished
    seconds: float
    told: dict
    pages: str  # what was written about it, for the student and the instructor
    left: set[str] = field(default_factory=set)


class Desk:
    """The workers of one sandbox: one for each kind of hostile task, and the neighbour's.

    The neighbour is graded for as long as anything hostile is, and not begun anew for each sample:
    what is true of it is found in `beside`, at the latest after `settle`.
    """

    def __init__(self, sandbox: str, neighbour: Path) -> None:
        self.beside: list[Beside] = []
        self._sandbox = sandbox
        self._neighbour_root = neighbour
        self._scratch = scratch_folder()
        self._out = self._scratch.with_name(f"{self._scratch.name}.out")
        self._running: Beside | None = None
        self._workers: dict[tuple[Path, Limits], Worker] = {}
        self._made = 0
        os.environ["COURSE_CANARY"] = CANARY
        self._at_first = _shared()
        self._nursery = Nursery()
        self._neighbour = self._worker(QUICK, Limits())
        self.alone = [self._alone() for _ in range(2)][-1]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers.values():
            worker.process.close()
        self._nursery.close()
        remove(self._scratch)
        remove(self._out)
        os.environ.pop("COURSE_CANARY", None)

    def _worker(self, tests: Path, limits: Limits) -> Worker:
        key = tests, limits
        if key not in self._workers:
            settings = Settings(
                SEED, tests, ("4.1", "4.2"), sandbox=self._sandbox, limits=limits, grace_s=60
            )
            folder = self._scratch / f"w{self._made}"
            self._made += 1
            process = WorkerProcess(settings, folder, self._nursery)
            assert process.answer() is None
            pid = self._nursery.pid(process._number)
            self._workers[key] = Worker(process, Fingerprints(settings), folder, pid)
        return self._workers[key]

    def _alone(self) -> float:
        self._begin_neighbour([])
        self._end_neighbour()
        return self.beside.pop().seconds

    def _begin_neighbour(self, samples: list[str]) -> None:
        self._running = Beside(samples)
        self._neighbour.begin(self._neighbour_root)

    def _end_neighbour(self) -> None:
        result, running = self._neighbour.process.answer().result, self._running
        running.reached, running.possible = result.score, result.max_score
        running.seconds = result.seconds
        self.beside.append(running)
        self._running = None

    def grade(self, root: Path, tests: Path, limits: Limits) -> Graded:
        """Grade the one submission in a folder, the neighbour beside it while that takes."""
        worker = self._worker(tests, limits)
        before = worker.leftovers() | _shared()
        started = time.monotonic()
        worker.begin(root)
        try:
            finished = self._await(worker.process, [path.name for path in root.iterdir()])
        except BaseException:  # what it would still say is not to be taken for the next one's
            self._workers.pop((tests, limits)).process.close()
            raise
        seconds = time.monotonic() - started
        left = (worker.leftovers() | _shared()) - before
        written = _write(self._out, finished)
        folder = report.student_folder(self._out, finished.result.student)
        return Graded(
            written,
            seconds,
            json.loads((folder / "results.json").read_text()),
            _joined(folder.glob("*.html"), self._out.glob(f"_instructor/{folder.name}/*.html")),
            left,
        )

    def _await(self, worker: WorkerProcess, names: list[str]) -> Finished:
        """Let the neighbour be graded until the worker has its result."""
        end = time.monotonic() + _LONGEST_S
        if self._running:
            self._running.samples += names
        with selectors.DefaultSelector() as selector:
            for each in (worker, self._neighbour.process):
                selector.register(each, selectors.EVENT_READ)
            while True:
                if self._running is None:
                    self._begin_neighbour([*names])
                ready = [key.fileobj for key, _ in selector.select(end - time.monotonic())]
                assert ready, "the worker gives no answer"
                if worker in ready:
                    return worker.answer()
                self._end_neighbour()

    def settle(self) -> set[str]:
        """Wait for the neighbour; give what is left that no worker needs to begin the next."""
        if self._running:
            self._end_neighbour()
        left = _shared() - self._at_first
        for worker in self._workers.values():
            left |= {each for each in worker.leftovers() if str(worker.folder) in each}
        # Each worker has what forks its kernels; nobody else is there.
        pids = processes.descendants(self._nursery._process.pid)
        if len(pids) != 2 * len(self._workers):
            left.add(f"processes {pids}")
        return left


@dataclass
class Worker:
    """A worker, and what is needed to give it a task and to see what is left of that."""

    process: WorkerProcess
    fingerprints: Fingerprints
    folder: Path
    pid: int

    def begin(self, root: Path) -> None:
        """Grade the one submission in a folder."""
        (source,) = find_submissions(root)
        task = Task(source.student, source.paths, self.fingerprints(source.paths))
        self.process.begin(task)

    def leftovers(self) -> set[str]:
        """List what a submission could leave here: processes, open files, sockets, mounts, files.

        What other programs do on this machine is not looked at, nor what the neighbour's worker
        does meanwhile: processes count that descend from this worker, which adopts what loses its
        parent, and files, sockets and mounts below its folder.
        """
        found = {f"process {pid}" for pid in processes.descendants(self.pid)}
        found.add(f"{len(list(Path(f'/proc/{self.pid}/fd').iterdir()))} descriptors of the worker")
        for table in ("/proc/net/unix", "/proc/mounts"):
            lines = Path(table).read_text(errors="replace").splitlines()
            found |= {f"{table} {line}" for line in lines if f"{self.folder}/" in line}
        return found | {str(path) for path in self.folder.iterdir()}


def _shared() -> set[str]:
    """List what is left where everybody may leave something."""
    found = {str(path) for folder in SHARED for path in Path(folder).glob("*left*")}
    for table in ("shm", "msg", "sem"):
        for line in Path(f"/proc/sysvipc/{table}").read_text().splitlines()[1:]:
            found.add(f"System V {table} {line.split()[0]}")
    return found


def _joined(*paths: Iterable[Path]) -> str:
    return "".join(p.read_text(errors="replace") for some in paths for p in some)
