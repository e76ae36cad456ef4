"""Starts sandboxed kernels from one warm interpreter."""

from __future__ import annotations

import os
import signal
import socket
import stat
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Self

from course_lib.grading.sandbox import places
from course_lib.grading.sandbox.box import Box
from course_lib.grading.sandbox.choice import SandboxError, choose
from course_lib.grading.sandbox.kernel import SandboxedKernel
from course_lib.grading.sandbox.limits import Limits

if TYPE_CHECKING:
    from types import TracebackType

_READY_SECONDS = 30.0
_FIRST_UID, _UIDS = 61184, 2000  # above what systems give to people, below their nobody


class Launcher:
    """Starts kernels; a context manager, one for each worker.

    Parameters
    ----------
    sandbox : str, optional
        See `choose`.
    limits : Limits, optional
        What each submission may use.
    zygote : tuple of int and socket, optional
        A child that serves the other end of the socket (`zygote.serve`); otherwise an interpreter
        is started.
    """

    def __init__(
        self,
        sandbox: str | None = None,
        limits: Limits | None = None,
        zygote: tuple[int, socket.socket] | None = None,
    ) -> None:
        self.sandbox = choose(sandbox)
        self.limits = limits or Limits()
        self._given = zygote
        self._zygote: subprocess.Popen[bytes] | _Child | None = None
        self._control: socket.socket | None = None
        self._is_ready = False
        self._uid = _spare_uid(self.sandbox)

    def __enter__(self) -> Self:
        if self._given:
            self._zygote, self._control = _Child(self._given[0]), self._given[1]
        else:
            self._zygote, self._control = _execute()
        self._control.settimeout(_READY_SECONDS)
        return self

    def await_ready(self) -> None:
        """Wait until kernels can be forked; done at the latest for the first of them.

        Raises
        ------
        SandboxError
            When the interpreter that forks them did not start.
        """
        if self._is_ready or self._control is None:
            return
        if self._control.recv(16) != b"ready":
            self.__exit__(None, None, None)
            raise SandboxError("the interpreter that forks kernels did not start")
        self._is_ready = True

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._control:
            self._control.close()
        if self._zygote:
            self._zygote.kill()
            self._zygote.wait()

    @property
    def pid(self) -> int | None:
        """The process that forks kernels."""
        return self._zygote.pid if self._zygote else None

    def is_alive(self) -> bool:
        """Tell whether it can start kernels; a submission's end never changes that."""
        return self._zygote is not None and self._zygote.poll() is None

    def kernel(self, folder: Path) -> SandboxedKernel:
        """Start a kernel.

        Parameters
        ----------
        folder : Path
            Its writable working folder: a copy that the caller made and will delete. Run by root,
            it is given to another user.

        Returns
        -------
        SandboxedKernel
            Ready.

        Raises
        ------
        SandboxError
            When the sandbox fails.
        LimitError
            When a limit is exceeded at once.
        """
        if self._control is None:
            raise SandboxError("use the launcher as a context manager")
        self.await_ready()
        uid = None if self._uid is None else self._uid + os.getpid() % _UIDS
        return SandboxedKernel(Box(self.sandbox, self._control, folder, self.limits, uid))


def _execute() -> tuple[subprocess.Popen[bytes], socket.socket]:
    mine, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with theirs:
        zygote = subprocess.Popen(  # noqa: S603
            [sys.executable, "-m", f"{__package__}.zygote", str(theirs.fileno())],
            pass_fds=(theirs.fileno(),),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            # Its home is where matplotlib keeps its list of fonts, which takes long to make.
            env=places.environment(os.environ.get("HOME", "/")),
            start_new_session=True,
        )
    return zygote, mine


class _Child:
    """A forked child, to be used like one that `subprocess` has started."""

    def __init__(self, pid: int) -> None:
        self.pid = pid
        self._ended = False

    def poll(self) -> int | None:
        if not self._ended:
            with suppress(ChildProcessError):
                if os.waitpid(self.pid, os.WNOHANG)[0] == 0:
                    return None
            self._ended = True
        return 0

    def kill(self) -> None:
        if self.poll() is None:
            os.kill(self.pid, signal.SIGKILL)

    def wait(self) -> None:
        if not self._ended:
            with suppress(ChildProcessError):
                os.waitpid(self.pid, 0)
            self._ended = True


def _spare_uid(sandbox: str) -> int | None:
    """Give the first of the user ids for students' processes; None to keep one's own.

    Only root can change it. Without a container the interpreter must also be reachable by others.
    """
    if os.getuid() != 0 or sandbox == "none":
        return None
    if sandbox == "bubblewrap":
        return _FIRST_UID
    needed = [Path(sys.base_prefix), Path(sys.prefix), places.COURSE]
    closed = any(
        not parent.stat().st_mode & stat.S_IXOTH
        for path in needed
        for parent in path.resolve().parents
    )
    return None if closed else _FIRST_UID
