"""Grades on an existing Dask cluster; its workers share no disk with this machine."""

from __future__ import annotations

import logging
import uuid
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from course_lib.grading import framing, remote, travel
from course_lib.grading.fingerprint import library
from course_lib.grading.messages import Finished, Settings, Started, Task, from_message
from course_lib.grading.results import SubmissionResult

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_CONNECT_SECONDS = 10
_AHEAD = 1.25  # tasks under way for each thread of the cluster: the next is there when one ends


class ClusterError(RuntimeError):
    """The cluster cannot be used; the message says why and what to do."""


class Cluster:
    """A Dask cluster.

    Parameters
    ----------
    address : str
        Of its scheduler, such as ``tcp://10.0.0.5:8786``.

    Attributes
    ----------
    settings : Settings
        To be set before `run`.

    Raises
    ------
    ClusterError
        When it does not answer.
    """

    settings: Settings

    def __init__(self, address: str) -> None:
        try:
            from distributed import Client  # noqa: PLC0415
        except ImportError as error:
            raise ClusterError(
                "--scheduler needs dask.distributed: pip install -e '.[cluster]'"
            ) from error
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # we say what is lost
        try:
            self._client: Any = Client(
                address, timeout=_CONNECT_SECONDS, set_as_default=False, name="course grade"
            )  # type: ignore[no-untyped-call]
        except (OSError, ValueError) as error:
            raise ClusterError(f"no Dask scheduler answers at {address}: {error}") from error
        self._address = address

    def choose(self, sandbox: str | None) -> str:
        """Choose a sandbox that works on every worker.

        Raises
        ------
        ClusterError
            When there is none, no worker, or a worker with another version of the course.
        """
        replies: dict[str, dict[str, str]] = self._client.run(
            remote.capabilities, sandbox, on_error="return"
        )
        if not replies:
            raise ClusterError(f"the cluster at {self._address} has no workers")
        ours = library()
        for address, reply in replies.items():
            if isinstance(reply, Exception):
                raise ClusterError(
                    f"the worker {address} cannot run the course; install it there "
                    f"({type(reply).__name__}: {reply})"
                )
            if reply["error"]:
                raise ClusterError(f"the worker {address}: {reply['error']}")
            if reply["library"] != ours:
                raise ClusterError(
                    f"the worker {address} has another version of the course or its libraries; "
                    "install the same on all machines, or grades would depend on the machine"
                )
        chosen = {reply["sandbox"] for reply in replies.values()}
        if len(chosen) > 1:
            raise ClusterError(
                f"the workers would use different sandboxes ({', '.join(sorted(chosen))}); "
                "name one with --sandbox"
            )
        return chosen.pop()

    def run(self, tasks: Iterable[Task]) -> Iterator[Started | Finished]:
        """Grade; leaving the iteration cancels what is under way."""
        from distributed import as_completed  # noqa: PLC0415

        run = uuid.uuid4().hex
        waiting = iter(tasks)
        under_way: dict[Any, Task] = {}
        completed: Any = as_completed(loop=self._client.loop)  # type: ignore[no-untyped-call]
        tests = travel.pack([self.settings.tests])
        try:
            while True:
                while len(under_way) < self._most() and (task := next(waiting, None)):
                    payload = _payload(run, self.settings, task, tests)
                    future = self._client.submit(
                        remote.grade,
                        payload,
                        key=f"grade-{run[:8]}-{len(task.student)}-{uuid.uuid4().hex}",
                        pure=False,
                    )
                    under_way[future] = task
                    completed.add(future)
                    yield Started(task.student)
                if not under_way:
                    return
                future = next(completed)
                yield _finished(future, under_way.pop(future))
        finally:
            self._client.cancel(list(under_way))
            self._client.run(remote.end, run, on_error="ignore")
            self._client.close()

    def _most(self) -> int:
        threads: dict[str, int] = self._client.nthreads()
        return max(1, round(sum(threads.values()) * _AHEAD))


def _payload(
    run: str, settings: Settings, task: Task, tests: tuple[list[travel.Entry], bytes]
) -> bytes:
    files, content = travel.pack(task.paths)
    message = {
        "run": run,
        "settings": settings.to_data(),
        "task": replace(task, paths=()).to_data(),
        "tests": tests[0],
        "files": files,
    }
    return framing.pack(message, [tests[1], content])


def _finished(future: Any, task: Task) -> Finished:  # noqa: ANN401
    if future.status == "finished":
        content, blobs = framing.unpack(future.result())
        return Finished(from_message(content["result"], blobs), str(content["failure"]))
    error = future.exception() if future.status == "error" else None
    reason = f"{type(error).__name__}: {error}" if error else f"the cluster has {future.status} it"
    event = f"could not be checked: {reason}"
    return Finished(SubmissionResult(task.student, (), events=(event,)), reason)
