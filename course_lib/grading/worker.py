"""
A process that grades one submission after the other, each in a child of its own (`attempt`).

It imports what grading needs once and forks: a child costs a few milliseconds. Whatever a
submission leaves behind, processes or files, is gone before the next begins. It is forked from the
`nursery` with a socket, on which it takes `Settings` and then `Task`s, and answers results.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import signal
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.grading import framing, lean
from course_lib.grading.attempt import AttemptError, HungUpError, attempt, describe, limit_threads
from course_lib.grading.messages import Settings, Task, to_message
from course_lib.grading.sandbox import Launcher, confine, processes
from course_lib.grading.scratch import remove
from course_lib.grading.unchecked import unchecked

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable

    from course_lib.grading.results import SubmissionResult

_CLEAN_SECONDS = 20.0


class Worker:
    """Grades what it is sent.

    Parameters
    ----------
    link : socket
        To the grader.
    settings : Settings
    scratch : Path
        An empty folder of its own, for temporary files.
    zygote : tuple of int and socket
        For the first launcher.
    """

    def __init__(
        self,
        link: socket.socket,
        settings: Settings,
        scratch: Path,
        zygote: tuple[int, socket.socket],
    ) -> None:
        self._link = link
        self._zygote: tuple[int, socket.socket] | None = zygote
        self._settings = settings
        self._scratch = scratch
        self._launcher: Launcher | None = None
        self._grade: Callable[..., SubmissionResult] = _no_grade

    def prepare(self) -> None:
        """Warm up, so that children find everything imported.

        Raises
        ------
        RuntimeError
            When a thread has started: its locks would stay locked in a fork.
        """
        launcher = self._start_launcher()
        with lean.for_good():
            lean.import_nbformat()
            module_name, _, name = self._settings.grade.partition(":")
            module = importlib.import_module(module_name)
            self._grade = getattr(module, name)
            warm_up = getattr(module, "warm_up", None)
            if warm_up:
                limit_threads()
                warm_up(self._settings.tests, self._settings.exercises)
        if len(list(Path("/proc/self/task").iterdir())) > 1:
            raise RuntimeError(
                "a thread runs in the worker, which must fork. Do hidden tests start one when they "
                "are imported?"
            )
        launcher.await_ready()

    def serve(self) -> None:
        """Answer tasks until the grader hangs up."""
        while True:
            try:
                data, _ = framing.receive(self._link)
            except (EOFError, OSError):
                return
            try:
                answer = self._answer(Task.from_data(data))
            except HungUpError:
                return
            self._link.sendall(answer)

    def close(self) -> None:
        """End everything that was started."""
        if self._launcher:
            with contextlib.suppress(OSError):
                self._launcher.__exit__(None, None, None)
            self._launcher = None
        _end_descendants(keep=None)
        remove(self._scratch)

    def _answer(self, task: Task) -> bytes:
        failure = ""
        try:
            content, blobs = self._with_second_try(task)
        except AttemptError as error:
            failure = str(error) if error.ours else ""
            content, blobs = self._unchecked(task, error)
        return framing.pack({"result": content, "failure": failure}, blobs)

    def _with_second_try(self, task: Task) -> framing.Message:
        if task.given_up:
            raise AttemptError(task.given_up, again=False, ours=True)
        try:
            return self._attempt(lambda: self._grade(task.job(self._settings), self._launcher))
        except AttemptError as error:
            self.close()  # nothing that the first try has touched is used again
            if not error.again:
                raise
        return self._attempt(lambda: self._grade(task.job(self._settings), self._launcher))

    def _unchecked(self, task: Task, error: AttemptError) -> framing.Message:
        reason = str(error)
        kept = "" if error.ours else task.fingerprint  # what was our fault is graded anew
        try:
            return self._attempt(
                lambda: replace(unchecked(task, self._settings, reason), fingerprint=kept)
            )
        except AttemptError:  # the hidden tests themselves cannot be read
            bare = Settings(b"", self._scratch, (), "", self._settings.limits)
            return to_message(replace(unchecked(task, bare, reason), fingerprint=kept))

    def _start_launcher(self) -> Launcher:
        if self._launcher is None:
            self._scratch.mkdir(mode=0o711, exist_ok=True)
            given, self._zygote = self._zygote, None
            launcher = Launcher(self._settings.sandbox, self._settings.limits, given)
            self._launcher = launcher.__enter__()
        return self._launcher

    def _attempt(self, make: Callable[[], SubmissionResult]) -> framing.Message:
        """Make a result in a child; nothing of it is left afterwards."""
        try:
            self._start_launcher().await_ready()
        except Exception as error:
            raise AttemptError(describe(error), again=True, ours=True) from error
        own = Path(tempfile.mkdtemp(prefix="", dir=self._scratch))
        own.chmod(0o711)  # the students' own user passes through to its working folder
        try:
            return attempt(make, self._link, own, self._settings)
        finally:
            self._tidy(own)

    def _tidy(self, own: Path) -> None:
        """End what the child left behind, and delete its files."""
        zygote = self._launcher.pid if self._launcher else None
        _end_descendants(keep=zygote)
        remove(own)
        if self._launcher and not self._launcher.is_alive():
            self._launcher.__exit__(None, None, None)
            self._launcher = None


def _no_grade(*_: object) -> SubmissionResult:
    raise RuntimeError("not prepared")


def _end_descendants(keep: int | None) -> None:
    """Kill every process below this one but one, and bury them all.

    What a sandbox is just about to end itself gets a moment for it.
    """
    start = time.monotonic()
    while time.monotonic() < start + _CLEAN_SECONDS:
        _bury(keep)
        strays = [pid for pid in processes.descendants(os.getpid()) if pid != keep]
        if not strays:
            return
        if time.monotonic() > start + 0.3:
            for pid in strays:
                with contextlib.suppress(OSError):
                    os.kill(pid, signal.SIGKILL)
        time.sleep(0.01)


def _bury(keep: int | None) -> None:
    """Wait for every child that has ended; the one to be kept is its owner's to wait for."""
    with contextlib.suppress(ChildProcessError):
        while (ended := os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)) is not None:
            if ended.si_pid == keep:
                return
            os.waitpid(ended.si_pid, 0)


def serve(link: socket.socket, zygote: tuple[int, socket.socket]) -> None:
    """Serve the grader.

    Parameters
    ----------
    link : socket
        To the grader.
    zygote : tuple of int and socket
        A child that forks kernels, and where it listens.
    """
    confine.become_subreaper()  # what a killed child leaves behind is found below this process
    first, _ = framing.receive(link)
    _take_over(first["environment"])
    scratch = Path(first["scratch"])
    tempfile.tempdir = str(scratch)
    worker: Worker | None = None
    try:
        worker = Worker(link, Settings.from_data(first["settings"]), scratch, zygote)
        worker.prepare()
        link.sendall(framing.pack({"ready": True}))
        worker.serve()
    except Exception as error:  # noqa: BLE001
        with contextlib.suppress(OSError):
            link.sendall(framing.pack({"error": describe(error)}))
    finally:
        if worker:
            worker.close()
        if _is_dead(first["grader"]):  # it was killed: nobody else will clear up
            scratch.with_name(f"{scratch.name}.log").unlink(missing_ok=True)
            with contextlib.suppress(OSError):  # the last worker to leave can
                scratch.parent.rmdir()


def _take_over(environment: dict[str, str]) -> None:
    """Use the grader's environment instead of the one that kernels are forked with."""
    os.environ.clear()
    os.environ.update(environment)
    paths = environment["PYTHONPATH"].split(os.pathsep)
    sys.path[:0] = [path for path in paths if path not in sys.path]


def _is_dead(pid: int) -> bool:
    try:
        return processes.fields(pid)[0] in b"ZX"
    except OSError:
        return True
