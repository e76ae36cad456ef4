"""
A container of bubblewrap's making: own mounts, processes, network, and a home of its own.

bubblewrap runs nothing of the student's. It holds the namespaces open with a sleeping command; the
kernel is forked from a warm interpreter (`zygote`) that steps into them, which saves the second
that Python would need to start inside. Ending bubblewrap's first process ends all that is in there.

As root the student's processes run under a user id of their own; as an ordinary user they run in a
user namespace, where they own nothing but their folder.
"""

from __future__ import annotations

import contextlib
import json
import os
import select
import shutil
import signal
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.grading.sandbox import confine, places, processes

if TYPE_CHECKING:
    from course_lib.grading.sandbox.limits import Limits

_START_SECONDS = 10
_END_SECONDS = 10
_SHARED = 64  # MiB at most, as below
_IN_MEMORY = (("/tmp", 128), (places.HOME, 64))  # noqa: S108


class Container:
    """The namespaces of one submission.

    Parameters
    ----------
    folder : Path
        What appears, writable, as the working folder.
    uid : int or None
        The user id of the student's processes, when run by root.
    limits : Limits
        Without a user id of their own the student's processes can rewrite the container's: these
        are bound as they are.

    Raises
    ------
    OSError
        When bubblewrap cannot make it.
    """

    def __init__(self, folder: Path, uid: int | None, limits: Limits) -> None:
        # The command tells when the mounts are made; bubblewrap's own report comes before them.
        info_out, info_in = os.pipe()
        filter_out, filter_in = os.pipe()
        with os.fdopen(filter_in, "wb") as program:
            program.write(confine.denying(local_only=False))
        command = ["bwrap", *_arguments(folder, uid), "--info-fd", str(info_in)]
        command += ["--seccomp", str(filter_out), "--"]
        command += ["/bin/sh", "-c", "echo; exec sleep infinity >/dev/null 2>&1"]
        self._process = subprocess.Popen(  # noqa: S603
            command,
            pass_fds=(info_in, filter_out),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={"PATH": "/usr/bin:/bin"},
        )
        os.close(info_in)
        os.close(filter_out)
        with os.fdopen(info_out, "rb") as info:
            if self._process.stdout is None or self._process.stdout.read(1) != b"\n":
                _, complaint = self._process.communicate(timeout=_START_SECONDS)
                raise OSError(f"bubblewrap failed: {complaint.decode(errors='replace').strip()}")
            self.first_pid = int(json.loads(info.read())["child-pid"])
        self.pidfd = os.pidfd_open(self.first_pid)
        for pid in [self.first_pid, *self.pids()]:
            confine.set_limits(limits, limits.processes, pid)

    def end(self) -> None:
        """Kill everything in the container and wait until it is gone."""
        with contextlib.suppress(ProcessLookupError):
            signal.pidfd_send_signal(self.pidfd, signal.SIGKILL)
            # It is gone when all in its space are, also those that it never started.
            select.select([self.pidfd], [], [], _END_SECONDS)
        self._process.kill()
        self._process.communicate()

    def close(self) -> None:
        """Forget the container, which has been ended."""
        os.close(self.pidfd)

    def pids(self) -> list[int]:
        """List the container's processes, without its first, which adopts who loses a parent."""
        return processes.descendants(self.first_pid)

    def in_memory(self) -> list[str]:
        """List the container's file systems in memory, as seen from outside."""
        places_of_it = ["/dev/shm", *(path for path, _ in _IN_MEMORY)]  # noqa: S108
        return [f"/proc/{self.first_pid}/root{path}" for path in places_of_it]


def _arguments(folder: Path, uid: int | None) -> list[str]:
    spaces = ["--unshare-pid", "--unshare-net", "--unshare-ipc", "--unshare-uts"]
    spaces += ["--unshare-cgroup-try", "--die-with-parent", "--new-session", "--hostname", "course"]
    if uid is None:
        # Its own root, without any power: only then may a user mount pseudo-terminals.
        spaces += ["--unshare-user", "--uid", "0", "--gid", "0"]
    targets = [*places.readable(), *places.course(), Path(places.WORK)]
    parents = {parent for target in targets for parent in target.parents} - {Path("/")}
    mounts: list[str] = []
    # Before what may lie below: a course in /tmp must still be seen.
    for path, size in _IN_MEMORY:
        mounts += ["--perms", "1777", "--size", str(size * 2**20), "--tmpfs", path]
    for parent in sorted(parents):  # bubblewrap would make them for its own eyes only
        mounts += ["--perms", "0755", "--dir", str(parent)]
    for place in places.readable():
        if place.is_symlink():
            mounts += ["--symlink", str(place.readlink()), str(place)]
        else:
            mounts += ["--ro-bind", str(place.resolve()), str(place)]
    mounts += ["--proc", "/proc", "--dev", "/dev"]
    mounts += ["--ro-bind", "/dev/null", "/dev/zero"]  # mapped, it is memory that nobody counts
    mounts += ["--perms", "1777", "--size", str(_SHARED * 2**20), "--tmpfs", "/dev/shm"]  # noqa: S108
    for part in places.course():
        mounts += ["--ro-bind", str(part), str(part)]
    # What `places.lay_out_pictures` puts beside the working folder.
    mounts += ["--symlink", str(places.pictures()), f"{places.HOME}/{places.pictures().name}"]
    # ROS looks up the name of the machine that it is on, and there is nobody to ask.
    mounts += ["--ro-bind", str(Path(__file__).with_name("hosts")), "/etc/hosts"]
    mounts += ["--bind", str(folder), places.WORK, "--chdir", places.WORK]
    return [*spaces, *mounts, "--remount-ro", "/"]


def complaint() -> str | None:
    """Say why bubblewrap cannot be used here; None if it can."""
    if shutil.which("bwrap") is None:
        return "bubblewrap is not installed (Debian: apt install bubblewrap)"
    test = ["bwrap", "--unshare-pid", "--unshare-net", "--ro-bind", "/", "/", "true"]
    done = subprocess.run(test, capture_output=True, check=False, timeout=_START_SECONDS)  # noqa: S603
    if done.returncode:
        return f"bubblewrap does not work here: {done.stderr.decode(errors='replace').strip()}"
    return None
