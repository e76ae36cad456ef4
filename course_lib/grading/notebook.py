"""A student's notebook under nbval, in a sandboxed kernel that is started anew when it dies."""

from __future__ import annotations

import shutil
import time
from dataclasses import dataclass
from itertools import islice
from queue import Empty
from typing import TYPE_CHECKING, Any

from course_lib.grading.channel import Channel, KernelGoneError, Message
from course_lib.grading.pictures import pictures_of
from course_lib.grading.sandbox import LimitError, SandboxError, places
from course_lib.grading.scratch import remove
from course_lib.grading.text import clean

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from course_lib.grading.sandbox import Launcher, Limits, SandboxedKernel

_MOST_STARTS = 10
_MOST_PICTURES = 40
_INTERRUPT_SECONDS = 1.5


@dataclass(frozen=True)
class Cell:
    """How a code cell of the notebook ran: its number (from 1) and, if it failed, why."""

    number: int
    error: str | None


class Notebook:
    """One notebook's execution.

    A cell that kills or hangs its kernel costs that cell: a new kernel executes the others again,
    so that the functions they define can be judged.

    Parameters
    ----------
    launcher : Launcher
        Starts kernels.
    original : Path
        The submission's files.
    folder : Path
        The working folder, to be made; each new kernel finds the submission's files there, however
        the last one left it.
    limits : Limits
        Seconds and bytes.
    deadline : float
        On `time.monotonic`, when the whole submission must be done.

    Attributes
    ----------
    cells : list of Cell
        How each code cell ran.
    pictures : list of ndarray
        What the notebook drew, BGR uint8.
    events : list of str
        Limits that were hit.
    overdue : bool
        Whether the last cell took too long and ended only with its kernel.
    """

    def __init__(
        self, launcher: Launcher, original: Path, folder: Path, limits: Limits, deadline: float
    ) -> None:
        self.cells: list[Cell] = []
        self.pictures: list[NDArray[np.uint8]] = []
        self.events: list[str] = []
        self.overdue = False
        self._launcher = launcher
        self._original = original
        self._folder = folder
        self._limits = limits
        self._deadline = deadline
        self._kernel: SandboxedKernel | None = None
        self._channel: Channel | None = None
        self._starts = 0
        self._why_no_other = "it had died too often, or the time for this submission was up"
        self._sources: list[str] = []  # cells that left their kernel alive
        self._running = ("", "")  # request and source
        self._updates: dict[str, Mapping[str, Any]] = {}  # of displays, the last of each

    def seconds_left(self) -> float:
        """Seconds that the submission still has."""
        return max(0.0, self._deadline - time.monotonic())

    def channel(self) -> Channel:
        """Give the channel to a living kernel; a new one is brought to where the old one was.

        Raises
        ------
        KernelGoneError
            When kernels died too often, or time is up.
        SandboxError
            When there is no sandbox for a new one.
        """
        if self._channel and self._kernel and not self._channel.ended and self._kernel.is_alive():
            return self._channel
        self.close()
        if self._starts >= _MOST_STARTS or not self.seconds_left():
            raise KernelGoneError(self._why_no_other)
        self._starts += 1
        self._lay_out()
        try:
            self._kernel = self._launcher.kernel(self._folder)
        except LimitError as error:
            self.events.append(str(error))
            self._starts = _MOST_STARTS  # the next would do no better
            self._why_no_other = str(error)
            raise KernelGoneError(self._why_no_other) from None
        self._channel = Channel(self._kernel, self._limits.output_bytes)
        for source in list(self._sources):
            if not self._execute_again(source):
                self._sources.remove(source)
                return self.channel()
        return self._channel

    def _lay_out(self) -> None:
        remove(self._folder)
        try:
            shutil.copytree(self._original, self._folder)
            places.lay_out_pictures(self._folder)
        except OSError as error:  # the disk is full: staged files are plain
            raise SandboxError(f"the working folder could not be made: {error}") from error

    def _execute_again(self, source: str) -> bool:
        if self._channel is None:
            return False
        try:
            request = self.send(source)
            self._channel.reply(request, "execute_reply", self._soon(self._limits.cell_s))
        except (Empty, KernelGoneError):
            self.interrupt()
            return False
        self._channel.drain()
        return not self._channel.ended

    def send(self, source: str) -> str:
        """Send a cell's source to the kernel; gives the request's id."""
        content = {"code": source, "silent": False, "store_history": True} | {
            "user_expressions": {},
            "allow_stdin": False,
            "stop_on_error": False,
        }
        if self._channel is None:
            raise KernelGoneError
        return self._channel.send("execute_request", content)

    def begin(self, source: str) -> str:
        """Send a cell for the first time; it counts as bad until its last output is in."""
        self.channel()
        self.overdue = False
        request = self.send(source)
        self._running = (request, source)
        return request

    def _soon(self, seconds: float) -> float:
        return min(time.monotonic() + seconds, self._deadline)

    def reply(self, request: str, seconds: float) -> Message:
        """Wait for a cell to end."""
        if self._channel is None:
            raise KernelGoneError
        return self._channel.reply(request, "execute_reply", self._soon(seconds))

    def output(self, seconds: float) -> Message:
        """Give the next output."""
        if self._channel is None:
            raise KernelGoneError
        message = self._channel.output(self._soon(seconds))
        request, source = self._running
        self._keep_update(message)
        idle = message["content"].get("execution_state") == "idle"
        if idle and message["parent_header"].get("msg_id") == request:
            self._sources.append(source)
        return message

    def _keep_update(self, message: Message) -> None:
        """Keep what an output was replaced by; nbval looks at new outputs only."""
        if message.get("msg_type") == "update_display_data":
            place = str(message["content"].get("transient"))[:200]
            data = message["content"].get("data")
            if isinstance(data, dict) and len({*self._updates, place}) <= _MOST_PICTURES:
                self._updates[place] = data

    def interrupt(self) -> None:
        """Stop what the kernel does; end the kernel if it does not listen."""
        if not (self._kernel and self._channel and self._kernel.is_alive()):
            return
        self._kernel.interrupt()
        try:
            request = self._channel.send("kernel_info_request", {})
            self._channel.reply(request, "kernel_info_reply", self._soon(_INTERRUPT_SECONDS))
        except (Empty, KernelGoneError):
            self.events.append("ignored an interrupt")
            self.overdue = True
            self._channel.ended = True
            self._kernel.kill()

    def reason_of_death(self) -> str:
        """Say which limit the last kernel broke, if any."""
        events = list(self._kernel.events) if self._kernel else []
        return ", ".join(clean(event) for event in events)

    def close(self) -> None:
        """End the kernel and everything it started."""
        if self._channel:
            self.events += self._channel.events
            self._channel = None
        if self._kernel:
            self._kernel.close()
            self.events += self._kernel.events
            self._kernel = None

    def record(self, outputs: Iterable[Mapping[str, Any]], error: str | None) -> None:
        """Keep how a cell ran and what it drew."""
        self.cells.append(Cell(len(self.cells) + 1, error))
        drawn = [output.get("data", {}) for output in outputs]
        drawn += self._updates.values()
        self._updates = {}
        for data in drawn:
            self.pictures += islice(pictures_of(data), _MOST_PICTURES - len(self.pictures))
