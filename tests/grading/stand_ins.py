"""Graders that stand in the session's place, to test how the runner takes what may go wrong there.

A worker imports them by name; what one is to do stands in the submission itself.
"""

from __future__ import annotations

import ctypes
import gc
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from course_lib.grading.results import Picture, SubmissionResult, TestResult
from course_lib.grading.sandbox import Launcher, SandboxError
from course_lib.grading.session import Job

PNG = b"\x89PNG\r\n\x1a\n" + bytes(range(256))


class Deed(NamedTuple):
    job: Job
    launcher: Launcher
    text: str


def grade(job: Job, launcher: Launcher) -> SubmissionResult:
    """Do what the submission's `do.txt` says, line by line; then all points."""
    events = []
    for line in (job.paths[0] / "do.txt").read_text().splitlines():
        events += _do(Deed(job, launcher, line))
    tests = (TestResult("Does it", "4.1.1", 2.0, 2.0, "", "passed"),)
    return SubmissionResult(
        job.student,
        tests,
        events=tuple(events),
        pictures=(Picture("one", PNG),),
        code={"4.1": frozenset({3, 2**31})},
        fingerprint=job.fingerprint,
    )


def _do(deed: Deed) -> list[str]:
    word, _, rest = deed.text.partition(" ")
    return DEEDS[word](deed._replace(text=rest)) or []


def _sleep(deed: Deed) -> None:
    time.sleep(float(deed.text))


def _raise(deed: Deed) -> None:
    raise ValueError(deed.text)


def _sandbox_fails(deed: Deed) -> None:
    raise SandboxError(deed.text)


def _segfault(_: Deed) -> None:
    ctypes.string_at(0)


def _exit(deed: Deed) -> None:
    os._exit(int(deed.text))


def _hog(_: Deed) -> None:
    kept = []
    while True:
        kept.append(bytearray(os.urandom(1024)) * (64 << 10))


def _hang(_: Deed) -> None:
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    while True:
        time.sleep(1)


def _leave_processes(deed: Deed) -> None:
    for _ in range(5):
        command = [sys.executable, "-c", "import time; time.sleep(300)", deed.text]
        subprocess.Popen(command, start_new_session=True)


def _leave_files(deed: Deed) -> None:
    closed = Path(tempfile.mkdtemp(prefix=deed.text)) / "closed"
    closed.mkdir()
    (closed / "file").touch()
    closed.chmod(0)


def _count(deed: Deed) -> list[str]:
    """Say how much with a mark is there."""
    count = 0
    for entry in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            count += deed.text.encode() in entry.read_bytes()
        except OSError:
            continue
    files = list(Path(tempfile.gettempdir()).parent.rglob(f"*{deed.text}*"))
    return [f"{count} processes, {len(files)} files"]


def _kill_parent(_: Deed) -> None:
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(60)


def _kill_zygote(deed: Deed) -> None:
    os.kill(deed.launcher.pid or 0, signal.SIGKILL)
    time.sleep(0.2)


def _kernel(deed: Deed) -> list[str]:
    """Run a line in a real sandboxed kernel, which is left running."""
    folder = Path(tempfile.mkdtemp())
    folder.chmod(0o711)
    (folder / "work").mkdir()
    kernel = deed.launcher.kernel(folder / "work")
    return [kernel.client.execute_interactive(deed.text, timeout=30)["content"]["status"]]


def _once(deed: Deed) -> list[str]:
    """Do something at the first try alone."""
    seen = deed.job.paths[0] / f"seen {deed.text}"
    if seen.exists():
        return []
    seen.touch()
    return _do(deed)


def _memory(_: Deed) -> list[str]:
    gc.collect()
    return [f"pages {Path(f'/proc/{os.getppid()}/statm').read_text().split()[1]}"]


def _print(_: Deed) -> None:
    print("x" * 200_000)
    os.write(2, b"y" * 200_000)


def _where(_: Deed) -> list[str]:
    # An editable install puts the name of its import hook there, which is no folder.
    relative = [p for p in sys.path if not p.startswith("/") and not p.endswith("__path_hook__")]
    return [f"cwd {Path.cwd()}", f"path {relative}"]


def _unwritable(_: Deed) -> list[str]:
    return [7]  # type: ignore[list-item]


DEEDS = {
    "unwritable": _unwritable,
    "sleep": _sleep,
    "raise": _raise,
    "sandbox_fails": _sandbox_fails,
    "segfault": _segfault,
    "exit": _exit,
    "hog": _hog,
    "hang": _hang,
    "leave_processes": _leave_processes,
    "leave_files": _leave_files,
    "count": _count,
    "kill_parent": _kill_parent,
    "kill_zygote": _kill_zygote,
    "kernel": _kernel,
    "once": _once,
    "memory": _memory,
    "print": _print,
    "where": _where,
    "pass": lambda _: None,
}
