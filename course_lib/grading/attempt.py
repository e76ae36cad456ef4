"""
One try at grading a submission, in a child of the worker's.

The child's memory goes with it, and its crash or hang is its own: the worker learns of them here.
"""

from __future__ import annotations

import ctypes
import os
import resource
import select
import signal
import socket
import sys
import tempfile
import time
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.grading import framing
from course_lib.grading.messages import Settings, from_message, to_message

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_lib.grading.results import SubmissionResult

_PR_SET_PDEATHSIG = 1
_LINGER_SECONDS = 2.0
_libc = ctypes.CDLL(None, use_errno=True)


class HungUpError(Exception):
    """The grader wants no more of this worker."""


class AttemptError(Exception):
    """A grading child gave no result.

    Attributes
    ----------
    again : bool
        Whether another try may succeed.
    ours : bool
        Whether the grader itself failed, as it says.
    """

    def __init__(self, reason: str, *, again: bool, ours: bool) -> None:
        super().__init__(reason)
        self.again = again
        self.ours = ours


def attempt(
    make: Callable[[], SubmissionResult], link: socket.socket, folder: Path, settings: Settings
) -> framing.Message:
    """Make a result in a child.

    Parameters
    ----------
    make : callable
        Grades.
    link : socket
        To the grader, who may hang up meanwhile.
    folder : Path
        Where the child's temporary files go.
    settings : Settings
        How long it may take, and how much memory.

    Returns
    -------
    content, blobs
        A result's message (`messages.to_message`).

    Raises
    ------
    AttemptError
        When none came.
    HungUpError
        When the grader did.
    """
    mine, theirs = socket.socketpair()
    me = os.getpid()
    child = os.fork()
    if child == 0:
        link.close()
        mine.close()
        _be_child(theirs, make, folder, me, settings.own_bytes)
    theirs.close()
    handle = os.pidfd_open(child)
    try:
        with mine:
            data = _await(mine, handle, link, settings.limits.wall_s + settings.grace_s)
        content, blobs = framing.unpack(data)
    except (AttemptError, framing.BrokenMessageError) as error:
        os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        if isinstance(error, AttemptError):
            raise
        how = _ended(status)
        raise AttemptError(f"the grading process {how}", again=True, ours=False) from error
    except HungUpError:
        os.kill(child, signal.SIGKILL)
        raise
    else:
        if select.select([handle], [], [], _LINGER_SECONDS)[0] == []:
            os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    finally:
        os.close(handle)
    if "error" in content:
        raise AttemptError(str(content["error"]), again=bool(content["again"]), ours=True)
    from_message(content, blobs)  # what is no result is found here, not in the grader
    return content, blobs


def limit_threads() -> None:
    """Keep OpenCV to one thread: a worker for each processor is enough, and threads do not fork."""
    if "cv2" in sys.modules:
        sys.modules["cv2"].setNumThreads(1)


def describe(error: BaseException) -> str:
    """Name an error, what it says, and where it arose."""
    place = traceback.extract_tb(error.__traceback__)[-1:]
    where = f" ({Path(place[0].filename).name}, line {place[0].lineno})" if place else ""
    return f"{type(error).__name__}: {str(error)[:1000]}{where}"


def _await(mine: socket.socket, handle: int, link: socket.socket, limit: float) -> bytes:
    """Read what a child says until it hangs up."""
    deadline = time.monotonic() + limit
    data = bytearray()
    watched: list[Any] = [mine, handle, link]
    while True:
        left = deadline - time.monotonic()
        ready, _, _ = select.select(watched, [], [], max(0.0, left))
        if link in ready:
            raise HungUpError
        if mine in ready:
            chunk = mine.recv(1 << 20)
            if not chunk:
                return bytes(data)
            data += chunk
            if len(data) > framing.MOST_BYTES:
                raise AttemptError("the result was too large", again=False, ours=False)
        elif handle in ready:
            return bytes(data)
        elif not ready:
            reason = f"grading took longer than {limit:.0f} s and was stopped"
            raise AttemptError(reason, again=False, ours=False)


def _be_child(
    link: socket.socket,
    make: Callable[[], SubmissionResult],
    own: Path,
    parent: int,
    own_bytes: int,
) -> None:
    """Grade, send, end; never returns."""
    try:
        _libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        if os.getppid() != parent:
            os._exit(1)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_DATA, (own_bytes, own_bytes))
        tempfile.tempdir = str(own)
        limit_threads()
        try:
            data = framing.pack(*to_message(make()))
        except BaseException as error:  # noqa: BLE001  (whatever happens is said)
            again = not isinstance(error, MemoryError)
            data = framing.pack({"error": describe(error), "again": again})
        link.sendall(data)
        link.close()
    finally:
        os._exit(0)


def _ended(status: int) -> str:
    code = os.waitstatus_to_exitcode(status)
    if code >= 0:
        return f"ended early, with status {code}"
    return f"was ended by {signal.Signals(-code).name}"
