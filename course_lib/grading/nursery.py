"""
A warm interpreter that workers are forked from, and before each of them what forks its kernels.

What students' kernels need to import takes a second of processor time; workers need half of the
same. Here it is imported once for all. This process is executed anew, with a student's environment,
and never hears a secret: a worker is told its seed, its tests and the grader's environment over a
socket of its own, which this process does not read, after the `zygote` beside it has been forked.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import select
import signal
import socket
import subprocess
import sys
import tempfile
import time
import traceback
from pathlib import Path
from typing import Any

from course_lib.grading.sandbox import confine, places, processes

_START_SECONDS = 120.0  # to import everything, on a busy machine
_STATUS_SECONDS = 2.0
_MOST_MESSAGE = 256


class Nursery:
    """The interpreter as seen from the grader; for one thread.

    Parameters
    ----------
    nodes : bool, optional
        Whether to import what ROS nodes need, too.
    """

    def __init__(self, *, nodes: bool = True) -> None:
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._complaints = tempfile.TemporaryFile()  # noqa: SIM115  (closed by `close`)
        self._made = 0
        self._pids: dict[int, tuple[int, int]] = {}  # by number: process, handle
        self._statuses: dict[int, int] = {}
        with theirs:
            self._process = subprocess.Popen(  # noqa: S603
                [sys.executable, "-P", "-m", __name__, str(theirs.fileno()), str(int(nodes))],
                pass_fds=(theirs.fileno(),),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=self._complaints,
                # A folder of submissions may be the current one: nothing there may be imported.
                cwd="/",
                # Its home is where matplotlib keeps its list of fonts, which takes long to make.
                env=places.environment(os.environ.get("HOME", "/")),
                start_new_session=True,  # a terminal's Ctrl-C is for the grader alone
            )

    def start(self, link: socket.socket, complaints: int) -> int:
        """Start a worker.

        Parameters
        ----------
        link : socket
            It will listen there.
        complaints : int
            Descriptor of a file for what it writes to its standard error.

        Returns
        -------
        int
            The number by which it is known here.
        """
        self._made += 1
        with contextlib.suppress(OSError):  # it has ended: the link will tell
            socket.send_fds(self._control, [b"start"], [link.fileno(), complaints])
        return self._made

    def wait(self, number: int, seconds: float) -> bool:
        """Wait for a worker's end.

        Returns
        -------
        bool
            Whether it came.
        """
        if self.pid(number) is None:
            return True  # it never was, and never will be
        handle = self._pids[number][1]
        return bool(select.select([handle], [], [], seconds)[0])

    def status(self, number: int) -> int | None:
        """Give a worker's exit status, as `subprocess` gives it; None when it is not known."""
        deadline = time.monotonic() + _STATUS_SECONDS
        while number not in self._statuses and self._hear(deadline):
            pass
        return self._statuses.get(number)

    def pid(self, number: int) -> int | None:
        """Give a worker's process; None when it could not be started."""
        deadline = time.monotonic() + _START_SECONDS
        while number not in self._pids and self._hear(deadline):
            pass
        return self._pids[number][0] if number in self._pids else None

    def is_alive(self) -> bool:
        """Tell whether workers can be started."""
        return self._process.poll() is None

    def last_words(self) -> str:
        """Give the end of what it complained about."""
        self._complaints.seek(0)
        return self._complaints.read()[-2000:].decode(errors="replace").strip()

    def close(self) -> None:
        """End it, if that has not been done; its workers have ended before."""
        if self._complaints.closed:
            return
        self._control.close()
        if not self._made:
            self._process.kill()  # it may be warming up, and would hear of the end only then
        try:
            self._process.wait(_STATUS_SECONDS)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        for _, handle in self._pids.values():
            os.close(handle)
        self._pids.clear()
        self._complaints.close()

    def _hear(self, deadline: float) -> bool:
        """Read one message; False when none comes."""
        if not select.select([self._control], [], [], max(0.0, deadline - time.monotonic()))[0]:
            return False
        try:
            message, handles, _, _ = socket.recv_fds(self._control, _MOST_MESSAGE, 1)
        except OSError:
            return False
        if not message:
            return False
        number, kind, value = json.loads(message)
        if kind == "started":
            self._pids[number] = value, handles[0]
        else:
            self._statuses[number] = value
        return True


class _Ward:
    """The workers as seen from the interpreter that forks them."""

    def __init__(self, control: socket.socket) -> None:
        self._control = control
        self._made = 0
        self._workers: dict[int, tuple[int, int]] = {}  # by handle: number, process

    def serve(self) -> None:
        """Start workers and say how they end, until the grader hangs up and all have ended."""
        listening = True
        while listening or self._workers:
            watched: list[Any] = [*self._workers, *([self._control] if listening else [])]
            ready = select.select(watched, [], [])[0]
            for handle in [each for each in ready if each in self._workers]:
                self._bury(handle)
            if self._control in ready:
                message, descriptors, _, _ = socket.recv_fds(self._control, _MOST_MESSAGE, 2)
                listening = bool(message)
                if message:
                    self._start(*descriptors)

    def _start(self, link: int, complaints: int) -> None:
        self._made += 1
        pid = os.fork()
        if pid == 0:
            self._control.close()
            for handle in self._workers:
                os.close(handle)
            _be_worker(link, complaints)
        os.close(link)
        os.close(complaints)
        handle = os.pidfd_open(pid)
        self._workers[handle] = self._made, pid
        self._tell("started", self._made, pid, handle)

    def _bury(self, handle: int) -> None:
        number, pid = self._workers.pop(handle)
        os.close(handle)
        status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        # What a killed worker could not end itself comes to this process.
        while strays := self._strays():
            for stray in strays:
                with contextlib.suppress(OSError):
                    os.kill(stray, signal.SIGKILL)
                with contextlib.suppress(ChildProcessError):
                    os.waitpid(stray, 0)
        self._tell("ended", number, status)

    def _strays(self) -> list[int]:
        known = {pid for _, pid in self._workers.values()}
        found = []
        for pid in processes.everybody():
            with contextlib.suppress(OSError, ValueError, IndexError):
                if processes.parent(pid) == os.getpid() and pid not in known:
                    found.append(pid)
        return found

    def _tell(self, kind: str, number: int, value: int, *handles: int) -> None:
        with contextlib.suppress(OSError):  # the grader is gone
            socket.send_fds(self._control, [json.dumps([number, kind, value]).encode()], handles)


def _be_worker(link: int, complaints: int) -> None:
    """Fork a zygote, then be the worker beside it; never returns."""
    status = 1
    try:
        os.setsid()
        os.dup2(complaints, 2)
        os.close(complaints)
        _name("worker")
        zygote = _fork_zygote(link)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        # Only now, so that no kernel has it in its memory.
        worker = importlib.import_module("course_lib.grading.worker")
        worker.serve(socket.socket(fileno=link), zygote)
        status = 0
    except BaseException:  # noqa: BLE001  (whatever happens is said)
        traceback.print_exc()
        sys.stderr.flush()
    finally:
        os._exit(status)


def _fork_zygote(link: int) -> tuple[int, socket.socket]:
    mine, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    pid = os.fork()
    if pid == 0:
        try:
            os.setsid()
            os.close(link)
            mine.close()
            os.dup2(1, 2)  # nowhere
            _name("zygote")
            importlib.import_module("course_lib.grading.sandbox.zygote").serve(theirs)
        finally:
            os._exit(0)
    theirs.close()
    return pid, mine


def _name(name: str) -> None:
    """Be told apart in a list of processes."""
    Path("/proc/self/comm").write_text(name)


def main() -> None:
    """Serve the grader on the socket whose number is the first argument; the second: nodes run."""
    control = socket.socket(fileno=int(sys.argv[1]))
    _name("nursery")
    importlib.import_module("course_lib.grading.sandbox.zygote").warm_up(nodes=sys.argv[2] == "1")
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    confine.become_subreaper()
    _Ward(control).serve()
    os._exit(0)  # the grader waits: there is nothing to tidy up in this interpreter


if __name__ == "__main__":
    main()
