"""Worker processes on this machine."""

from __future__ import annotations

import os
import selectors
from collections import Counter, deque
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.grading.messages import Finished, Settings, Started, Task
from course_lib.grading.nursery import Nursery
from course_lib.grading.process import WorkerError, WorkerLostError, WorkerProcess
from course_lib.grading.results import SubmissionResult
from course_lib.grading.scratch import remove, scratch_folder

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_MOST_LOSSES = 2  # workers that one submission may cost before it is given up


def usable_cpus() -> int:
    """Count the processors that this process may use, a container's share included.

    Returns
    -------
    int
        At least 1.
    """
    count = len(os.sched_getaffinity(0))
    with suppress(OSError, ValueError):
        quota, period = Path("/sys/fs/cgroup/cpu.max").read_text().split()
        count = min(count, round(int(quota) / int(period)))
    return max(1, count)


class Pool:
    """Grades with some workers at a time.

    Parameters
    ----------
    settings : Settings
    workers : int
        How many at most.
    nursery : Nursery, optional
        Where the first workers come from; it is closed with them.
    """

    def __init__(self, settings: Settings, workers: int, nursery: Nursery | None = None) -> None:
        self._settings = settings
        self._most = max(1, workers)
        self._selector = selectors.DefaultSelector()
        # A second one is made if the first has died.
        self._nurseries = [nursery] if nursery else []
        self._workers: list[WorkerProcess] = []
        self._waiting: deque[Task] = deque()
        self._losses: Counter[str] = Counter()
        self._made = 0
        self._scratch = Path()

    def run(self, tasks: Iterable[Task]) -> Iterator[Started | Finished]:
        """Grade, and say when each submission begins and what came of it.

        Whenever the iteration is left, also by an exception, no process remains.

        Raises
        ------
        WorkerError
            When no worker can start.
        """
        self._waiting.extend(tasks)
        self._scratch = scratch_folder()
        try:
            for _ in range(min(self._most, len(self._waiting))):
                self._add()
            while self._workers:
                for key, _ in self._selector.select():
                    yield from self._hear(key.fileobj)  # type: ignore[arg-type]
        finally:
            try:
                self._close()
            except KeyboardInterrupt:  # the only one: the next are not heard
                self._close()
                raise

    def _add(self) -> None:
        if not self._nurseries or not self._nurseries[-1].is_alive():
            self._nurseries.append(Nursery(nodes="4.2" in self._settings.exercises))
        folder = self._scratch / str(self._made)
        worker = WorkerProcess(self._settings, folder, self._nurseries[-1])
        self._made += 1
        self._workers.append(worker)
        self._selector.register(worker, selectors.EVENT_READ)

    def _drop(self, worker: WorkerProcess) -> None:
        self._selector.unregister(worker)
        self._workers.remove(worker)
        worker.close()

    def _hear(self, worker: WorkerProcess) -> Iterator[Started | Finished]:
        try:
            finished = worker.answer()
        except WorkerLostError as error:
            yield from self._lost(worker, str(error))
            return
        lost = ""
        task = self._waiting.popleft() if self._waiting else None
        if task:
            try:
                worker.begin(task)  # now: it need not wait until the result has been written
            except WorkerLostError as error:
                lost = str(error)
        if finished:
            yield finished
        if task:
            yield Started(task.student)
        else:
            self._drop(worker)
        if lost:
            yield from self._lost(worker, lost)

    def _lost(self, worker: WorkerProcess, reason: str) -> Iterator[Finished]:
        """Replace a worker, and grade again what it was grading."""
        task = worker.task
        self._drop(worker)
        if task is None and not worker.ready:
            raise WorkerError(reason)
        if task is not None:
            self._losses[task.student] += 1
            losses = self._losses[task.student]
            if losses < _MOST_LOSSES:
                self._waiting.appendleft(task)
            elif losses == _MOST_LOSSES:
                given_up = Task(task.student, task.paths, task.fingerprint, given_up=reason)
                self._waiting.appendleft(given_up)
            else:
                event = f"could not be checked: {reason}"
                yield Finished(SubmissionResult(task.student, (), events=(event,)), reason)
        if self._waiting:
            self._add()

    def _close(self) -> None:
        for worker in self._workers:
            worker.hang_up()  # all at once, so that they end side by side
        for worker in self._workers:
            worker.close()
        self._workers.clear()
        for nursery in self._nurseries:
            nursery.close()
        self._selector.close()
        remove(self._scratch)
