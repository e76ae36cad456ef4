"""A student's notebook under nbval, in a sandboxed kernel that is started anew when it dies."""

from __future__ import annotations

import base64
import binascii
import io
import re
import shutil
import time
from queue import Empty
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, UnidentifiedImageError

from course_lib.grading.channel import Channel, KernelGoneError, Message
from course_lib.grading.sandbox import LimitError, SandboxError, places
from course_lib.grading.scratch import remove
from course_lib.grading.student import Cell
from course_lib.grading.text import clean

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from course_lib.grading.sandbox import Launcher, Limits, SandboxedKernel

_MOST_STARTS = 10
_MOST_PICTURES = 40
_MOST_PIXELS = 16_000_000
_MOST_BASE64 = 12_000_000
_INTERRUPT_SECONDS = 1.5
_WITHIN_TEXT = re.compile(r"data:image/(?:png|jpe?g);base64,([A-Za-z0-9+/=]++)")


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
            self._starts, self._why_no_other = (
                _MOST_STARTS,
                str(error),
            )  # the next would do no better
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
            for encoded in _encoded(data):
                if len(self.pictures) < _MOST_PICTURES:
                    self.pictures += picture_from(encoded)


def _encoded(data: Mapping[str, Any]) -> Iterator[str]:
    """Give the pictures of an output: those that it is, and those within its HTML or markdown."""
    for kind in ("image/png", "image/jpeg"):
        if isinstance(data.get(kind), str):
            yield data[kind]
    for kind in ("text/html", "text/markdown"):
        if isinstance(data.get(kind), str):
            yield from (match[1] for match in _WITHIN_TEXT.finditer(data[kind]))


def picture_from(encoded: str) -> list[NDArray[np.uint8]]:
    """Decode a picture that a stranger made: one, or none if it is not an ordinary picture.

    Parameters
    ----------
    encoded : str
        Base64 of a PNG or JPEG.

    Returns
    -------
    list of ndarray
        BGR uint8, at most one.
    """
    if len(encoded) > _MOST_BASE64:
        return []
    try:
        return picture_in(base64.b64decode(encoded))
    except (ValueError, binascii.Error):
        return []


def picture_in(data: bytes) -> list[NDArray[np.uint8]]:
    """Decode a picture file that a stranger made: one, or none if it is no ordinary picture.

    Parameters
    ----------
    data : bytes
        A PNG, JPEG or BMP file.

    Returns
    -------
    list of ndarray
        BGR uint8, at most one.
    """
    try:
        with Image.open(io.BytesIO(data), formats=("PNG", "JPEG", "BMP")) as picture:
            if picture.width * picture.height > _MOST_PIXELS:
                return []
            rgb = np.asarray(picture.convert("RGBA").convert("RGB"), np.uint8)
    except (OSError, ValueError, SyntaxError, UnidentifiedImageError):
        return []
    except Image.DecompressionBombError:
        return []
    return [np.ascontiguousarray(rgb[..., ::-1])]


class NbvalKernel:
    """What nbval's cells call, on top of a `Notebook`; stands in for its `RunningKernel`.

    Parameters
    ----------
    notebook : Notebook
        The execution.
    """

    language = "python"

    def __init__(self, notebook: Notebook) -> None:
        self._notebook = notebook

    def is_alive(self) -> bool:
        """Tell whether a cell can be executed; a dead kernel is replaced."""
        try:
            self._notebook.channel()
        except KernelGoneError:
            return False
        return True

    def execute_cell_input(self, source: str, **_: object) -> str:
        """Send a cell."""
        return self._notebook.begin(source)

    def await_reply(self, request: str, timeout: float) -> None:
        """Wait until a cell has ended; `queue.Empty` when that takes too long."""
        self._notebook.reply(request, timeout)

    def get_message(self, stream: str, timeout: float) -> Message:
        """Give the next output message."""
        if stream != "iopub":
            raise ValueError(stream)
        return self._notebook.output(timeout)

    def await_idle(self, request: str, timeout: float) -> None:
        """Read outputs until the cell has ended."""
        while True:
            message = self.get_message("iopub", timeout)
            if message["parent_header"].get("msg_id") == request and (
                message["content"].get("execution_state") == "idle"
            ):
                return

    def interrupt(self) -> None:
        """Stop the running cell."""
        self._notebook.interrupt()

    def stop(self) -> None:
        """Leave the kernel to its notebook, which ends it after the hidden tests."""
