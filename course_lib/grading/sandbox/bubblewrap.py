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
import shutil
import signal
import subprocess
from pathlib import Path

from course_lib.grading.sandbox import places

_START_SECONDS = 10
_ROOT = 0


class Container:
    """The namespaces of one submission.

    Parameters
    ----------
    folder : Path
        What appears, writable, as the working folder.
    uid : int or None
        The user id of the student's processes, when run by root.

    Raises
    ------
    OSError
        When bubblewrap cannot make it.
    """

    def __init__(self, folder: Path, uid: int | None) -> None:
        # The command tells when the mounts are made; bubblewrap's own report comes before them.
        info_out, info_in = os.pipe()
        command = ["bwrap", *_arguments(folder, uid), "--info-fd", str(info_in), "--"]
        command += ["/bin/sh", "-c", "echo; exec sleep infinity >/dev/null 2>&1"]
        self._process = subprocess.Popen(  # noqa: S603
            command,
            pass_fds=(info_in,),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={"PATH": "/usr/bin:/bin"},
        )
        os.close(info_in)
        with os.fdopen(info_out, "rb") as info:
            if self._process.stdout is None or self._process.stdout.read(1) != b"\n":
                _, complaint = self._process.communicate(timeout=_START_SECONDS)
                raise OSError(f"bubblewrap failed: {complaint.decode(errors='replace').strip()}")
            self.first_pid = int(json.loads(info.read())["child-pid"])
        self.pidfd = os.pidfd_open(self.first_pid)

    def end(self) -> None:
        """Kill everything in the container and wait until it is gone."""
        with contextlib.suppress(ProcessLookupError):
            signal.pidfd_send_signal(self.pidfd, signal.SIGKILL)
        self._process.kill()
        self._process.communicate()

    def close(self) -> None:
        """Forget the container, which has been ended."""
        os.close(self.pidfd)

    def pids(self) -> list[int]:
        """List the processes in the container, without its own two."""
        mine = Path(f"/proc/{self.first_pid}/ns/pid")
        try:
            space = mine.readlink()
        except OSError:
            return []
        found = []
        for entry in os.scandir("/proc"):
            if entry.name.isdigit():
                with contextlib.suppress(OSError):
                    if Path(f"/proc/{entry.name}/ns/pid").readlink() == space:
                        found.append(int(entry.name))
        return [pid for pid in found if pid != self.first_pid]


def _arguments(folder: Path, uid: int | None) -> list[str]:
    spaces = ["--unshare-pid", "--unshare-net", "--unshare-ipc", "--unshare-uts"]
    spaces += ["--unshare-cgroup-try", "--die-with-parent", "--new-session", "--hostname", "course"]
    if uid is None:
        # Its own root, without any power: only then may a user mount pseudo-terminals.
        spaces += ["--unshare-user", "--uid", "0", "--gid", "0"]
    targets = [*places.readable(), *places.course(), Path(places.WORK)]
    parents = {parent for target in targets for parent in target.parents} - {Path("/")}
    mounts: list[str] = []
    for parent in sorted(parents):  # bubblewrap would make them for its own eyes only
        mounts += ["--perms", "0755", "--dir", str(parent)]
    for place in places.readable():
        if place.is_symlink():
            mounts += ["--symlink", str(place.readlink()), str(place)]
        else:
            mounts += ["--ro-bind", str(place.resolve()), str(place)]
    mounts += ["--proc", "/proc", "--dev", "/dev"]
    for path, size in (("/dev/shm", 64), ("/tmp", 128), (places.HOME, 64)):  # noqa: S108
        mounts += ["--perms", "1777", "--size", str(size * 2**20), "--tmpfs", path]
    for part in places.course():
        mounts += ["--ro-bind", str(part), str(part)]
    # What `places.lay_out_pictures` puts beside the working folder.
    mounts += ["--symlink", str(places.pictures()), f"{places.HOME}/{places.pictures().name}"]
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
