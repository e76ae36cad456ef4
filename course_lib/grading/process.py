"""A worker process as seen from the grader."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
from pathlib import Path
from typing import TYPE_CHECKING

import course_lib
from course_lib.grading import framing
from course_lib.grading.messages import Finished, Settings, Task, from_message
from course_lib.grading.nursery import Nursery
from course_lib.grading.sandbox import processes
from course_lib.grading.scratch import remove

if TYPE_CHECKING:
    from collections.abc import Mapping

_SEND_SECONDS = 60.0
_END_SECONDS = 30.0
_COURSE = Path(course_lib.__file__).resolve().parents[1]


class WorkerError(RuntimeError):
    """A worker could not start."""


class WorkerLostError(RuntimeError):
    """A worker ended by itself."""


class WorkerProcess:
    """Starts a worker and talks with it.

    Parameters
    ----------
    settings : Settings
    scratch : Path
        A folder for its temporary files; it must not exist.
    nursery : Nursery, optional
        Where it is forked; by default in one of its own.
    """

    def __init__(self, settings: Settings, scratch: Path, nursery: Nursery | None = None) -> None:
        self.task: Task | None = None
        self.ready = False
        self._scratch = scratch
        scratch.mkdir(mode=0o711)
        self._link, theirs = socket.socketpair()
        self._link.settimeout(_SEND_SECONDS)  # it is asked only when it has something to say
        self._complaints = scratch.with_name(f"{scratch.name}.log")
        self._nursery = nursery or Nursery()
        self._has_own = nursery is None
        with theirs, self._complaints.open("wb") as complaints:
            self._number = self._nursery.start(theirs, complaints.fileno())
        first = {
            "settings": settings.to_data(),
            "scratch": str(scratch),
            "environment": environment(os.environ),
            "grader": os.getpid(),
        }
        self._link.sendall(framing.pack(first))

    def fileno(self) -> int:
        """Give the socket's number, for selectors."""
        return self._link.fileno()

    def begin(self, task: Task) -> None:
        """Give it something to do."""
        self.task = task
        try:
            self._link.sendall(framing.pack(task.to_data()))
        except OSError as error:
            raise WorkerLostError(self._last_words()) from error

    def answer(self) -> Finished | None:
        """Read what it says; None when it says that it is ready.

        Raises
        ------
        WorkerError
            When it could not start.
        WorkerLostError
            When it has ended.
        """
        try:
            content, blobs = framing.receive(self._link)
        except (EOFError, OSError, framing.BrokenMessageError) as error:
            raise WorkerLostError(self._last_words()) from error
        if "error" in content:
            raise WorkerError(str(content["error"]))
        if "ready" in content:
            self.ready = True
            return None
        self.task = None
        return Finished(from_message(content["result"], blobs), str(content["failure"]))

    def hang_up(self) -> None:
        """Tell it to end; it takes what it has started with it."""
        self._link.close()

    def close(self) -> None:
        """End it, wait for it, and leave nothing of it behind."""
        self.hang_up()
        if not self._nursery.wait(self._number, _END_SECONDS):
            worker = self._nursery.pid(self._number)
            for pid in [*processes.descendants(worker), worker] if worker else []:
                with contextlib.suppress(OSError):
                    os.kill(pid, signal.SIGKILL)
            self._nursery.wait(self._number, _END_SECONDS)
        if self._has_own:
            self._nursery.close()
        remove(self._scratch)
        self._complaints.unlink(missing_ok=True)

    def _last_words(self) -> str:
        ended = self._nursery.wait(self._number, 1.0)
        code = self._nursery.status(self._number) if ended else None
        how = "hung up" if not ended else f"ended with status {code}"
        if code is not None and code < 0:
            how = f"was ended by {signal.Signals(-code).name}"
        said = self._complaints.read_bytes()[-2000:].decode(errors="replace").strip()
        said = said or self._nursery.last_words()
        return f"a worker {how}" + (f": {said.splitlines()[-1]}" if said else "")


def environment(given: Mapping[str, str]) -> dict[str, str]:
    """Give the environment of a worker.

    Parameters
    ----------
    given : mapping
        That of this process.

    Returns
    -------
    dict
    """
    kept = {name: value for name, value in given.items() if not name.startswith("PYTEST_")}
    paths = [str(_COURSE)]
    paths += [str(Path(p).resolve()) for p in given.get("PYTHONPATH", "").split(os.pathsep) if p]
    return kept | {
        "PYTHONPATH": os.pathsep.join(dict.fromkeys(paths)),
        "PYTHONDONTWRITEBYTECODE": "1",
        # One worker for each processor; and a library's threads must not run when it forks.
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
        "MKL_NUM_THREADS": "1",
    }
