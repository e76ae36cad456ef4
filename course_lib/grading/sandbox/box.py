"""One kernel's box: its container or keeper, its sockets, its watcher, and the end of them all."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import socket
import tempfile
import threading
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.grading.sandbox import places, processes
from course_lib.grading.sandbox.bubblewrap import Container
from course_lib.grading.sandbox.choice import SandboxError
from course_lib.grading.sandbox.watcher import Watcher
from course_lib.grading.scratch import remove

if TYPE_CHECKING:
    from course_lib.grading.sandbox.limits import Limits

_START_SECONDS = 20.0
_END_SECONDS = 10.0
_BACKLOG = 16
_COURSE = ".course"


class Box:
    """Holds one kernel and everything it starts.

    Parameters
    ----------
    sandbox : str
        ``"bubblewrap"``, ``"sandlock"`` or ``"none"``.
    control : socket
        Leads to the zygote.
    folder : Path
        The writable working folder.
    limits : Limits
    uid : int or None
        User id for the student's processes; None: this process's own.

    Attributes
    ----------
    address : str
        Prefix of the sockets' paths.
    events : list of str
        Limits that were exceeded.
    """

    def __init__(
        self, sandbox: str, control: socket.socket, folder: Path, limits: Limits, uid: int | None
    ) -> None:
        self.events: list[str] = []
        self._sandbox = sandbox
        self._control = control
        self._folder = folder
        self._limits = limits
        self._uid = uid
        self._ending = threading.Lock()
        self._ended = False
        self._pid = self._handle = self._keeper = -1
        # The student cannot see this folder: what the grader connects to cannot be exchanged.
        self._sockets = Path(tempfile.mkdtemp(prefix="k-"))
        self.address = str(self._sockets / "s")
        self._home = Path(tempfile.mkdtemp(prefix="home-"))
        self._container: Container | None = None
        self._answer: socket.socket | None = None
        folders = [folder, self._home]
        self._watcher = Watcher(self._pids, folders, self._in_memory, limits, self._exceeded)

    def start(self, key: str) -> None:
        """Start the kernel.

        Parameters
        ----------
        key : str
            For signing messages; the student's code knows it too.

        Raises
        ------
        SandboxError
            When the sandbox cannot be made.
        """
        inside = self._sandbox == "bubblewrap"
        home = places.HOME if inside else str(self._home)
        work = places.WORK if inside else str(self._folder)
        environment = places.environment(home)
        if not inside:
            places.lay_out_course(self._home / _COURSE)
            paths = [str(self._home / _COURSE), environment["PYTHONPATH"]]
            environment |= {"TMPDIR": home, "PYTHONPATH": os.pathsep.join(paths)}
        if self._uid is not None:
            _give(self._folder, self._uid)
            _give(self._home, self._uid)
        request = {
            "sandbox": self._sandbox,
            "limits": asdict(self._limits),
            "connection": {"ip": "/tmp/s" if inside else f"{home}/s", "key": key},  # noqa: S108
            "uid": self._uid,
            "home": home,
            "work": work,
            "environment": environment,
            "others": self._others(inside=inside),
        }
        listeners = [self._listen(port) for port in range(1, len(places.CHANNELS) + 1)]
        self._answer, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        descriptors = [theirs.fileno()]
        try:
            if inside:
                self._container = Container(self._folder, self._uid, self._limits)
                descriptors.append(self._container.pidfd)
            descriptors += [listener.fileno() for listener in listeners]
            socket.send_fds(self._control, [json.dumps(request).encode()], descriptors)
            theirs.close()
            self._await_answer(self._answer)
        except (OSError, TimeoutError) as error:
            self.end()
            raise SandboxError(f"the sandbox could not be started: {error}") from error
        finally:
            theirs.close()
            for listener in listeners:
                listener.close()
        self._watcher.start()

    def _others(self, *, inside: bool) -> int:
        """Count the user's other processes: the system's own limit counts them, too.

        With room to spare, so that a submission that starts many leaves some for its neighbours
        until the watcher ends it.
        """
        if self._uid is not None or inside:
            return 0
        return processes.threads_of(os.getuid()) + 2 * self._limits.processes

    def _listen(self, port: int) -> socket.socket:
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(f"{self.address}-{port}")
        listener.listen(_BACKLOG)
        return listener

    def _await_answer(self, answer: socket.socket) -> None:
        answer.settimeout(_START_SECONDS)
        message, handles, _, _ = socket.recv_fds(answer, 8192, 2)
        if not handles:
            raise OSError(message.decode(errors="replace") or "the zygote gave no answer")
        self._pid = int(json.loads(message)["pid"])
        self._handle, self._keeper = handles

    def _pids(self) -> list[int]:
        if self._pid < 0:
            return []
        if self._container:
            kernel = [self._pid, *processes.descendants(self._pid)]
            return list(dict.fromkeys([*kernel, *self._container.pids()]))
        try:
            return processes.descendants(processes.parent(self._pid))
        except OSError:
            return []

    def _in_memory(self) -> list[str]:
        return self._container.in_memory() if self._container else []

    def _exceeded(self, what: str) -> None:
        self.events.append(what)
        self.end()

    def is_alive(self) -> bool:
        """Tell whether the kernel's process lives."""
        if self._handle < 0 or self._ended:
            return False
        return not select.select([self._handle], [], [], 0)[0]

    def wait(self) -> None:
        """Wait until the kernel's process has ended."""
        select.select([self._handle], [], [])

    def signal(self, number: int) -> None:
        """Send a signal to the kernel and its foreground children."""
        if self.is_alive():
            with contextlib.suppress(OSError):
                os.killpg(self._pid, number)
            with contextlib.suppress(OSError):
                signal.pidfd_send_signal(self._handle, number)

    def end(self) -> None:
        """Kill everything and wait until it is gone; may be called twice, from any thread."""
        with self._ending:
            if self._ended:
                return
            self._ended = True
            self._watcher.stop()
            if self._container:
                self._container.end()
            if self._answer:
                with contextlib.suppress(OSError):
                    self._answer.shutdown(socket.SHUT_WR)  # the keeper's sign to end its own
                    self._answer.settimeout(_END_SECONDS)
                    self._answer.recv(1)
                self._answer.close()
            if self._keeper >= 0:
                # It has hung up, and may still be taking down the container's mounts.
                select.select([self._keeper], [], [], _END_SECONDS)

    def close(self) -> None:
        """End, and free every file and socket."""
        self.end()
        if self._watcher.is_alive() and threading.current_thread() is not self._watcher:
            self._watcher.join()
        for handle in (self._handle, self._keeper):
            if handle >= 0:
                os.close(handle)
        self._handle = self._keeper = -1
        if self._container:
            self._container.close()
            self._container = None
        for folder in (self._sockets, self._home):
            remove(folder)


def _give(folder: Path, uid: int) -> None:
    """Make a folder and all in it a user's own."""
    for parent, _, names in os.walk(folder):
        os.chown(parent, uid, uid)
        for name in names:
            os.lchown(os.path.join(parent, name), uid, uid)  # noqa: PTH118
