"""Programs that start others: ended and reaped with all that they started."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import time
import uuid
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_COLOURS = re.compile(r"\x1b\[[0-9;]*m|\x1b\][^\x07\x1b]*(?:\x07|\x1b\\)?")
_TO_END = 8.0  # seconds for a program to end its children before all are killed
_TO_FOLLOW = 3.0  # seconds for those whose starter has passed the signal on and ended, as rosbag's
_STEP = 0.02
_MARK = "COURSE_PROGRAM"
# A caller that is killed cannot end what it has started: then the system does, as Ctrl-C would.
_WITH_ME = ("/usr/bin/setpriv", "--pdeathsig", "INT")


class RosError(RuntimeError):
    """ROS itself did not do what it should; the message says what it printed."""


class Program:
    """A running program; its output goes to a file.

    roslaunch gives each node a session of its own, so no group holds them all. What a program
    starts inherits its environment, and a mark in it.

    Parameters
    ----------
    command : sequence of str
    environment : mapping of str to str
    printed : Path
        The file for its output.
    cwd : Path, optional
    feed : bool
        Whether it gets a pipe to read from.
    """

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        printed: Path,
        *,
        cwd: Path | None = None,
        feed: bool = False,
    ) -> None:
        self.name = " ".join(command)
        self.mark = uuid.uuid4().hex
        self._printed = printed
        with printed.open("wb") as output:
            self.process = subprocess.Popen(  # noqa: S603  (the caller's own choice)
                [*_WITH_ME, *command],
                stdin=subprocess.PIPE if feed else subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env={**environment, _MARK: self.mark},
                cwd=cwd,
                start_new_session=True,
            )

    @property
    def output(self) -> str:
        """What it and its children have printed so far, without colours."""
        return _COLOURS.sub("", self._printed.read_text(errors="replace"))

    @property
    def status(self) -> int | None:
        """Its exit status; None while it runs."""
        return self.process.poll()

    def wait(self, seconds: float) -> int:
        """Wait for its end.

        Parameters
        ----------
        seconds : float
            At most.

        Returns
        -------
        int
            Its exit status.

        Raises
        ------
        RosError
            When it still runs.
        """
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            raise RosError(f"{self.name} still ran after {seconds:g} s:\n{self.output}") from None

    def wait_for(self, text: str, seconds: float = 30.0) -> str:
        """Wait until it has printed a text.

        Parameters
        ----------
        text : str
            A regular expression.
        seconds : float, optional
            At most.

        Returns
        -------
        str
            What matched.

        Raises
        ------
        RosError
            When it ended or time passed without it.
        """
        deadline = time.monotonic() + seconds
        while True:
            ended = self.status is not None
            if found := re.search(text, self.output):
                return found[0]
            if ended or time.monotonic() > deadline:
                how = f"ended with status {self.status}" if ended else f"ran {seconds:g} s"
                raise RosError(f"{self.name} {how} without printing {text!r}:\n{self.output}")
            time.sleep(_STEP)

    def pids(self) -> list[int]:
        """List it and all that it has started, as far as they live."""
        return marked(self.mark)

    def end(self, number: int = signal.SIGINT) -> int:
        """End it and all that it started, as Ctrl-C does first, then by force.

        Parameters
        ----------
        number : int, optional
            The signal it gets first.

        Returns
        -------
        int
            Its exit status.
        """
        if self.status is None:
            self.process.send_signal(number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(_TO_END)
        deadline = time.monotonic() + _TO_FOLLOW
        while self.pids() and time.monotonic() < deadline:
            time.sleep(_STEP)
        while left := self.pids():
            for pid in left:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            time.sleep(_STEP)
        if self.process.stdin:
            with contextlib.suppress(OSError):  # nobody reads what is left in it
                self.process.stdin.close()
        return self.process.wait()


def marked(mark: str) -> list[int]:
    """List the living processes that a program of this mark has started, and itself."""
    sought = f"{_MARK}={mark}".encode()
    found = []
    for entry in os.scandir("/proc"):
        if entry.name.isdigit():
            with contextlib.suppress(OSError):  # it has ended, or is another user's
                # That of a process which has ended but was not waited for is empty.
                if sought in Path(entry.path, "environ").read_bytes().split(b"\0"):
                    found.append(int(entry.name))
    return found
