"""
What a hidden test holds of a student: functions to call, pictures, files. Data in, data out.

`student.locate_mug(mug, scene)` runs in the student's sandboxed kernel and gives what came back,
or raises a `StudentError` that says in the student's terms what went wrong.
"""

from __future__ import annotations

import time
from collections import defaultdict
from dataclasses import dataclass, field
from itertools import islice
from queue import Empty
from typing import TYPE_CHECKING, Any

import cv2

from course_lib.grading import agent, wire
from course_lib.grading.channel import KernelGoneError
from course_lib.grading.error_hints import hint
from course_lib.grading.text import clean

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from course_lib.grading.notebook import Notebook

_SECOND_CHANCES = 2  # hangs or deaths of one function before its other calls are not tried
_NODE_SECONDS = 60.0
_LAST = 2000  # characters of what a node said, no more than `clean` keeps
_ENDED = (
    "it ended its process, or crashed it, as OpenCV does where its objects are not made by their "
    "own functions, such as cv2.ORB() instead of cv2.ORB_create()"
)
_MOST_SAVED = 8  # pictures of a node; as many as `node_run` sends
_ROS_SECONDS = 60.0  # more, for ROS itself to start and end on a busy machine
_JPEG = [cv2.IMWRITE_JPEG_QUALITY, 95]


class StudentError(Exception):
    """What kept a student's function from giving a result, worded for the student."""


class NotSubmittedError(StudentError):
    """There is no notebook of this exercise."""


class Missing(StudentError):  # noqa: N818  (a rubric reads better so)
    """The notebook defines no such function."""


class NotDone(StudentError):  # noqa: N818
    """The function raises NotImplementedError."""


class Raised(StudentError):  # noqa: N818
    """The function raised an exception.

    Attributes
    ----------
    on_purpose : bool
        Whether the student's own line raises it.
    """

    def __init__(self, message: str, *, on_purpose: bool = False) -> None:
        super().__init__(message)
        self.on_purpose = on_purpose


class TimedOut(StudentError):  # noqa: N818
    """The function took too long."""


class Died(StudentError):  # noqa: N818
    """The process died, or was ended for breaking a limit."""


class BadValue(StudentError):  # noqa: N818
    """The returned value cannot be read: too large, too deep, or malformed."""


@dataclass(frozen=True)
class PackageFile:
    """A file of the student's ROS package.

    Attributes
    ----------
    data : bytes
        Its content.
    executable : bool
        Whether its owner may execute it.
    """

    data: bytes = field(repr=False)
    executable: bool


@dataclass(frozen=True)
class NodeRun:
    """What a ROS node did with the pictures it was given.

    Attributes
    ----------
    topics : dict of str to list of (int, object)
        What it published: stamp in ns, and an array (points, numbers), a BGR picture, a number or
        text.
    counts : dict of str to int
        How many messages it published on each topic.
    types : dict of str to str
        Of which type the messages on each topic are.
    unstamped : frozenset of str
        The topics on which the header's stamp is zero.
    files : dict of str to bytes
        The pictures it saved.
    error : str or None
        Why it ended, if it did not end well.
    log : str
        What it printed and logged.
    """

    topics: dict[str, list[tuple[int, Any]]]
    counts: dict[str, int]
    types: dict[str, str]
    unstamped: frozenset[str]
    files: dict[str, bytes] = field(repr=False)
    error: str | None
    log: str


@dataclass(frozen=True)
class Cell:
    """How a code cell of the notebook ran: its number (from 1) and, if it failed, why."""

    number: int
    error: str | None


class Student:
    """A student's work on one exercise.

    Parameters
    ----------
    notebook : Notebook
        The notebook, which has been executed; it starts its kernel anew when that dies.
    call_s : float
        Seconds that one call may take.
    ros : bool, optional
        Whether its nodes run on real ROS.

    Attributes
    ----------
    cells : list of Cell
        How each code cell ran.
    pictures : list of ndarray
        What the notebook drew, BGR uint8 (height, width, 3).
    """

    def __init__(self, notebook: Notebook, call_s: float, *, ros: bool = False) -> None:
        self._ros = ros
        self.cells = notebook.cells
        self.pictures = notebook.pictures
        self._notebook = notebook
        self._call_s = call_s
        self._failures: dict[str, list[str]] = defaultdict(list)
        self._package: dict[str, PackageFile] | None = None

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("_"):
            raise AttributeError(name)
        return lambda *args, timeout=None: self.call(name, *args, timeout=timeout)

    def call(self, function: str, *args: object, timeout: float | None = None) -> Any:  # noqa: ANN401
        """Call one of the student's functions.

        Parameters
        ----------
        function : str
            Its name.
        *args : object
            What `wire.encode` takes.
        timeout : float, optional
            Seconds; default the sandbox's limit for a call.

        Returns
        -------
        object
            What it returned, as data; `wire.Unknown` for an object of another type.

        Raises
        ------
        StudentError
            One of its kinds, worded for the student.
        """
        failures = self._failures[function]
        if len(failures) >= _SECOND_CHANCES:
            raise TimedOut(
                f"{failures[-1]} It was not called again after {len(failures)} of these."
            )
        return self._request(
            function, "call", {"function": function, "args": args}, timeout or self._call_s
        )

    @property
    def seconds(self) -> float:
        """Seconds that one call may take."""
        return self._call_s

    @property
    def names(self) -> list[str]:
        """The names of the notebook's callables."""
        found = self._request("the notebook", "names", {}, self._call_s)
        return [str(name) for name in found] if isinstance(found, list) else []

    @property
    def package(self) -> Mapping[str, PackageFile]:
        """The files below `unit4/`, as they stand after the notebook has run."""
        if self._package is None:
            found = self._request("unit4", "files", {"folder": "unit4"}, self._call_s)
            self._package = {
                clean(name, 200): PackageFile(bytes(data), executable is True)
                for name, (data, executable) in _pairs(found)
            }
        return self._package

    def run_node(
        self,
        path: str,
        frames: Sequence[tuple[int, NDArray[np.uint8]]],
        *,
        topic: str = "/camera/rgb/image_raw",
        params: Mapping[str, object] | None = None,
        remap: Mapping[str, str] | None = None,
        given: Sequence[str] = (),
        files: Mapping[str, bytes] | None = None,
        timeout: float = _NODE_SECONDS,
    ) -> NodeRun:
        """Run a node of the package on pictures.

        Parameters
        ----------
        path : str
            Its file, within `unit4/`.
        frames : sequence of (int, ndarray)
            Stamp in ns and BGR uint8 picture; sent as JPEG.
        topic : str, optional
            Where they are published.
        params : mapping, optional
            Private parameters; `$(find unit4)` in a text stands for the package's folder, and
            `$(env HOME)` for the working folder.
        remap : mapping of str to str, optional
            Names to use in place of others, as on a node's command line.
        given : sequence of str, optional
            What else stands on its command line, with the same folders.
        files : mapping of str to bytes, optional
            Files to put in the working folder first.
        timeout : float, optional
            Seconds.

        Returns
        -------
        NodeRun

        Raises
        ------
        StudentError
            When it could not be run at all.
        """
        timeout += _ROS_SECONDS * self._ros
        arguments = {
            "path": f"unit4/{path}",
            "stamps": [stamp for stamp, _ in frames],
            "frames": [cv2.imencode(".jpg", frame, _JPEG)[1].tobytes() for _, frame in frames],
            "topic": topic,
            "params": dict(params or {}),
            "remap": dict(remap or {}),
            "given": list(given),
            "files": dict(files or {}),
            "timeout": timeout,
            "ros": self._ros,
        }
        found = self._request(path, "run_node", arguments, timeout * (1 + self._ros) + 10)
        try:
            return NodeRun(
                topics={clean(str(n), 100): _messages(m) for n, m in found["topics"].items()},
                counts={clean(str(n), 100): int(c) for n, c in found["counts"].items()},
                types={clean(str(n), 100): clean(str(t), 100) for n, t in found["types"].items()},
                unstamped=frozenset(clean(str(n), 100) for n in found["unstamped"]),
                files={
                    clean(str(n), 200): _bytes(data)
                    for n, data in islice(found["files"].items(), _MOST_SAVED)
                },
                # The last line of a traceback says most.
                error=clean(error[-_LAST:]) if isinstance(error := found["error"], str) else None,
                log=clean(str(found["log"])[-_LAST:]),
            )
        except (TypeError, LookupError, ValueError, AttributeError, OverflowError) as error:
            raise BadValue(f"What {path} did could not be read.") from error

    def _request(self, what: str, operation: str, arguments: object, seconds: float) -> Any:  # noqa: ANN401
        try:
            tree, buffers = wire.encode(arguments)
        except wire.BadDataError as error:  # what the student made goes back in: a launch file's
            raise BadValue(f"What {what} is to be given cannot be sent: {error}.") from None
        try:
            channel = self._notebook.channel()  # a new kernel first executes the cells again
            deadline = time.monotonic() + min(seconds, self._notebook.seconds_left())
            request = channel.send(
                agent.REQUEST, {"operation": operation, "arguments": tree}, buffers
            )
            reply = channel.reply(request, agent.REPLY, deadline)
        except Empty:
            self._notebook.interrupt()
            self._failures[what].append(f"{what} took longer than {seconds:.0f} s and was stopped.")
            raise TimedOut(self._failures[what][-1]) from None
        except KernelGoneError as error:
            reason = self._notebook.reason_of_death() or clean(str(error)) or _ENDED
            self._failures[what].append(
                f"{what} was running when your notebook's process ended: {reason}."
            )
            raise Died(self._failures[what][-1]) from None
        return _outcome(what, reply["content"], reply.get("buffers", []))


def _outcome(what: str, content: Mapping[str, Any], buffers: Sequence[bytes]) -> Any:  # noqa: ANN401
    status = content.get("status")
    if status == "ok":
        try:
            return wire.decode(content.get("value"), buffers)
        except wire.BadDataError as error:
            raise BadValue(f"What {what} returned could not be read: {error}.") from error
    if status == "bad":
        raise BadValue(f"What {what} returned could not be read: {_text(content, 'message')}.")
    if status != "error":
        raise TimedOut(f"{what} was interrupted.")
    kind, message = _text(content, "type"), _text(content, "message")
    kinds = content.get("kinds")
    kinds = kinds if isinstance(kinds, list) else []
    if kind == "_MissingError":
        raise Missing(
            f"Your notebook has no function {what}: was its cell deleted, or its name changed?"
        )
    if "NotImplementedError" in kinds:
        raise NotDone(f"{what} is not done yet (it raises NotImplementedError).")
    line = _text(content, "line", 300)
    where = f" in the line `{line}`" if line else ""
    said = f"{what} raised {kind}: {message}{where}" if message else f"{what} raised {kind}{where}"
    raise Raised(f"{said.rstrip('.')}.{hint(kind, message)}", on_purpose=line.startswith("raise "))


def _text(content: Mapping[str, Any], name: str, limit: int = 2000) -> str:
    """Give a text of a reply; a stranger may put anything there, too deep even to be shown."""
    found = content.get(name)
    return clean(found, limit).strip() if isinstance(found, str) else ""


def _pairs(found: object) -> list[tuple[str, tuple[bytes, bool]]]:
    if not isinstance(found, dict):
        raise BadValue("The files of your package could not be read.")
    return [
        (str(name), value)
        for name, value in found.items()
        if isinstance(value, tuple) and len(value) == 2 and isinstance(value[0], bytes)
    ]


def _bytes(found: object) -> bytes:
    if not isinstance(found, bytes):  # of a number, `bytes` would make as many
        raise TypeError("not a file's content")
    return found


def _messages(found: object) -> list[tuple[int, Any]]:
    if not isinstance(found, list):
        raise TypeError("not a list of messages")
    return [(int(stamp), value) for stamp, value in found]
