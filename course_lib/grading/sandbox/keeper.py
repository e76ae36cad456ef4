"""The process between the launcher and a kernel: it confines itself, then forks the kernel."""

from __future__ import annotations

import contextlib
import json
import os
import resource
import signal
import socket
import sys
import time
from pathlib import Path
from typing import Any

from course_lib.grading.sandbox import confine, forks, places
from course_lib.grading.sandbox.limits import Limits
from course_lib.grading.sandbox.processes import descendants


def start(request: dict[str, Any], descriptors: list[int], answer: socket.socket) -> None:
    """Confine this process, fork the kernel, and answer with handles on it.

    Parameters
    ----------
    request : dict
        `sandbox`, `limits`, `connection`, `uid`, `home`, `environment`.
    descriptors : list of int
        The container's first process (bubblewrap only) and the four listening sockets.
    answer : socket
        Gets JSON, and descriptors of the kernel's process and of this one.
    """
    limits = Limits(**request["limits"])
    if request["sandbox"] == "bubblewrap":
        _into_container(descriptors.pop(0), request["uid"])
    else:
        confine.become_subreaper()
        if request["sandbox"] != "none":
            confine.bar_powers()
        if request["uid"] is not None:
            _become(request["uid"])
    reading, writing = os.pipe()
    asked, asking = socket.socketpair()
    pid = os.fork()
    if pid == 0:
        os.close(reading)
        asked.close()
        _run_kernel(request, descriptors, limits, writing, asking)
    os.close(writing)
    asking.close()
    for descriptor in descriptors:
        os.close(descriptor)
    handle = os.pidfd_open(pid)
    with os.fdopen(reading, "rb") as failure:
        problem = failure.read()  # ends when the kernel is about to run
    if problem:
        answer.send(problem[-4000:])
        return
    mine = os.pidfd_open(os.getpid())
    socket.send_fds(answer, [json.dumps({"pid": pid}).encode()], [handle, mine])
    os.close(handle)
    os.close(mine)
    if request["sandbox"] == "bubblewrap":
        _bury(pid)
    else:
        folders = (request["work"], request["home"])
        _guard(answer, _forks(asked, limits, folders))


def _into_container(pidfd: int, uid: int | None) -> None:
    if uid is None:
        confine.enter(pidfd, with_user=True)
        confine.bar_powers()
    else:
        confine.enter(pidfd, with_user=False)
        confine.bar_powers()
        _become(uid)
    os.close(pidfd)


def _become(uid: int) -> None:
    os.setgroups([])
    os.setresgid(uid, uid, uid)
    os.setresuid(uid, uid, uid)
    confine.stay_inspectable()


def _run_kernel(
    request: dict[str, Any],
    listeners: list[int],
    limits: Limits,
    writing: int,
    asking: socket.socket,
) -> None:
    """Be the kernel; never returns."""
    # Imported already, but only where kernels are forked: it takes long.
    from course_lib.grading.sandbox import bootstrap  # noqa: PLC0415

    status = 1
    try:
        os.setsid()
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        _close_all_but({*listeners, writing, asking.fileno()})
        os.environ.clear()
        os.environ.update(request["environment"])
        os.chdir(request["work"])
        sandboxed = request["sandbox"] != "none"
        confine.be_first_to_go()
        if request["sandbox"] == "sandlock":
            _landlock(request["work"], request["home"])
        if sandboxed:
            confine.give_up_powers()
        confine.set_limits(limits, limits.processes + request["others"])
        if sandboxed:
            confine.deny_calls(local_only=request["sandbox"] == "sandlock")
        if request["sandbox"] == "sandlock" and request["uid"] is None:
            _ask(asking)
        asking.close()
        os.close(writing)
        bootstrap.run(request["connection"], listeners, loopback=request["sandbox"] != "sandlock")
        status = 0
    except BaseException as error:  # noqa: BLE001
        with contextlib.suppress(OSError):
            os.write(writing, f"{type(error).__name__}: {error}".encode()[:4000])
    finally:
        os._exit(status)


def _close_all_but(kept: set[int]) -> None:
    nowhere = os.open(os.devnull, os.O_RDWR)
    for standard in (0, 1, 2):
        os.dup2(nowhere, standard)
    last = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    start_of_range = 3
    for descriptor in sorted(kept):
        os.closerange(start_of_range, descriptor)
        start_of_range = descriptor + 1
    os.closerange(start_of_range, min(last, 65536))


def _landlock(work: str, home: str) -> None:
    import sandlock  # noqa: PLC0415  (its library is loaded where it is used)

    readable = [*places.readable(), *places.course(), Path("/proc/self"), Path("/dev/urandom")]
    readable += [Path(p) for p in ("/dev/random", "/proc/cpuinfo", "/proc/meminfo")]
    writable = [work, home, "/dev/null"]
    sandlock.confine(
        sandlock.Sandbox(
            fs_readable=[str(path) for path in readable if path.exists()], fs_writable=writable
        )
    )


def _ask(asking: socket.socket) -> None:
    """Let the keeper count processes, which the system does not for root, nor by submission."""
    with contextlib.suppress(OSError):  # then the watcher alone ends who starts too many
        listener = forks.ask_for_each()
        socket.send_fds(asking, [b"x"], [listener])
        os.close(listener)


def _forks(asked: socket.socket, limits: Limits, folders: tuple[str, ...]) -> forks.Forks | None:
    with asked:
        _, listeners, _, _ = socket.recv_fds(asked, 1, 1)
    return forks.Forks(listeners[0], limits.processes, folders) if listeners else None


def _bury(pid: int) -> None:
    """Wait for the kernel's end: only its parent can, and the container ends when all are buried.

    The launcher waits for this process, which takes the container's mounts with it.
    """
    with contextlib.suppress(ChildProcessError):
        os.waitpid(pid, 0)


def _guard(answer: socket.socket, counted: forks.Forks | None) -> None:
    """Wait until the launcher hangs up; then end every descendant, however far it strayed."""
    for standard in (0, 1, 2):
        with contextlib.suppress(OSError):
            os.close(standard)
    if counted:
        counted.serve(until=answer.fileno())
    answer.recv(1)
    # Where nobody counts, root's processes may be without number: who ends them must come first.
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    mine = os.getpid()
    for _ in range(5000):
        strays = descendants(mine)
        for pid in strays:
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        with contextlib.suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        if not strays:
            break
        time.sleep(0.002)
    answer.close()
    sys.exit(0)
