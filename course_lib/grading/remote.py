"""What runs on a cluster's machines: takes a submission as data, gives its result as data.

A Dask worker runs tasks in threads and must not fork; so it starts the same worker processes as the
grader does on one machine, and keeps them for the run.
"""

from __future__ import annotations

import atexit
import select
import shutil
import tempfile
import threading
from dataclasses import replace
from pathlib import Path

from course_lib.grading import fingerprint, framing, travel
from course_lib.grading.messages import Finished, Settings, Task, to_message
from course_lib.grading.process import WorkerLostError, WorkerProcess
from course_lib.grading.sandbox import NoSandboxError, choose
from course_lib.grading.scratch import remove, scratch_folder

_MOST_LOSSES = 2


class EndedError(RuntimeError):
    """The grader has ended the run."""


class _Run:
    """The worker processes of one run on this machine."""

    def __init__(self, settings: Settings, tests: tuple[list[travel.Entry], bytes]) -> None:
        self.ended = False
        self._lock = threading.Lock()
        self._folder = scratch_folder()
        (self._folder / "tests").mkdir()
        unpacked = travel.unpack(*tests, self._folder / "tests")
        self._settings = replace(settings, tests=unpacked[0])
        self._idle: list[WorkerProcess] = []
        self._made = self._busy = 0

    def grade(self, task: Task, files: tuple[list[travel.Entry], bytes]) -> Finished:
        """Grade one submission in this thread."""
        with self._lock:
            if self.ended:
                raise EndedError
            self._busy += 1
        own = Path(tempfile.mkdtemp(dir=self._folder, prefix="s-"))
        try:
            (own / "files").mkdir()
            task = replace(task, paths=tuple(travel.unpack(*files, own / "files")))
            for _ in range(_MOST_LOSSES):
                try:
                    return self._try(task)
                except WorkerLostError as error:
                    reason = str(error)
            return self._try(replace(task, given_up=reason))
        finally:
            remove(own)
            with self._lock:
                self._busy -= 1
            self._remove_if_done()

    def _try(self, task: Task) -> Finished:
        worker = self._take()
        try:
            if not worker.ready:
                self._hear(worker)
            worker.begin(task)
            finished = self._result(worker)
        except BaseException:
            worker.close()
            raise
        with self._lock:
            self._idle.append(worker)
        return finished

    def _take(self) -> WorkerProcess:
        with self._lock:
            if self._idle:
                return self._idle.pop()
            self._made += 1
            number = self._made
        return WorkerProcess(self._settings, self._folder / str(number))

    def _hear(self, worker: WorkerProcess) -> Finished | None:
        while not select.select([worker], [], [], 0.5)[0]:
            if self.ended:
                raise EndedError
        return worker.answer()

    def _result(self, worker: WorkerProcess) -> Finished:
        while True:
            if finished := self._hear(worker):
                return finished

    def end(self) -> None:
        """End soon: what is under way notices within a second."""
        self.ended = True
        self._remove_if_done()

    def _remove_if_done(self) -> None:
        with self._lock:
            if self._busy or not self.ended:
                return
            idle, self._idle = self._idle, []
        for worker in idle:
            worker.close()
        shutil.rmtree(self._folder, ignore_errors=True)


_runs: dict[str, _Run] = {}
_ended: set[str] = set()
_lock = threading.Lock()


def capabilities(sandbox: str | None) -> dict[str, str]:
    """Say which sandbox works here, and which version of the course this is.

    Parameters
    ----------
    sandbox : str, optional
        See `sandbox.choose`.

    Returns
    -------
    dict of str to str
    """
    try:
        return {"sandbox": choose(sandbox), "error": "", "library": fingerprint.library()}
    except NoSandboxError as error:
        return {"sandbox": "", "error": str(error), "library": ""}


def grade(payload: bytes) -> bytes:
    """Grade a submission.

    Parameters
    ----------
    payload : bytes
        A message of `cluster`'s.

    Returns
    -------
    bytes
        The answer, as from a worker.
    """
    message, (tests, content) = framing.unpack(payload)
    name = message["run"]
    with _lock:
        if name in _ended:
            raise EndedError
        if name not in _runs:
            settings = Settings.from_data(message["settings"])
            _runs[name] = _Run(settings, (message["tests"], tests))
        run = _runs[name]
    finished = run.grade(Task.from_data(message["task"]), (message["files"], content))
    data, blobs = to_message(finished.result)
    return framing.pack({"result": data, "failure": finished.failure}, blobs)


def end(name: str) -> None:
    """End a run, here.

    Parameters
    ----------
    name : str
        Of the run.
    """
    with _lock:
        _ended.add(name)
        run = _runs.pop(name, None)
    if run:
        # Dask calls this where it also answers its scheduler: that must not wait.
        threading.Thread(target=run.end, daemon=True).start()


@atexit.register
def _end_all() -> None:
    for run in list(_runs.values()):
        run.end()
