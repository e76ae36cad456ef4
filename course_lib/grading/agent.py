"""
The grader's hand inside a student's kernel: it calls the student's functions and sends data back.

It answers one message type of its own on the kernel's shell channel, in the kernel's main thread,
so that an interrupt reaches a call as it reaches a cell. Nothing here protects the grader: a
student's code shares this process and can change every line of it. The grader's side
(`student`, `wire.decode`) takes all that arrives for what it is, a stranger's words.
"""

from __future__ import annotations

import stat
import traceback
from contextlib import chdir
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.grading import wire

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ipykernel.kernelapp import IPKernelApp

REQUEST, REPLY = "course_request", "course_reply"
_MOST_FILES = 1000  # no fewer than a submission may have
_TEXTS = frozenset({".xml", ".txt", ".py", ".launch", ".yaml", ".yml"})
_MOST_FILE_BYTES, _MOST_FILES_BYTES = 8 * 2**20, 24 * 2**20
_MOST_MESSAGE = 2000


def install(app: IPKernelApp) -> None:
    """Teach a kernel to answer the grader.

    Parameters
    ----------
    app : IPKernelApp
        Initialised, not yet started.
    """
    agent = _Agent(app.kernel)
    app.kernel.shell_handlers[REQUEST] = agent.answer


class _Agent:
    def __init__(self, kernel: Any) -> None:  # noqa: ANN401
        self._kernel = kernel
        self._home = Path.cwd()  # a notebook may change it
        self._operations: dict[str, Callable[..., object]] = {
            "call": self._call,
            "names": self._names,
            "files": self._at_home(_files),
            "run_node": self._at_home(_run_node),
        }

    def _at_home(self, operation: Callable[..., object]) -> Callable[..., object]:
        def at_home(**arguments: object) -> object:
            with chdir(self._home):
                return operation(**arguments)

        return at_home

    def answer(self, stream: Any, identity: Any, message: Mapping[str, Any]) -> None:  # noqa: ANN401
        """Do what a request asks and send what came of it."""
        content = message["content"]
        buffers: list[bytes] = []
        try:
            arguments = wire.decode(content["arguments"], message["buffers"])
            tree, buffers = wire.encode(self._operations[content["operation"]](**arguments))
            reply = {"status": "ok", "value": tree}
        except wire.BadDataError as error:
            reply = {"status": "bad", "message": str(error)}
        except KeyboardInterrupt:
            reply = {"status": "interrupted"}
        except BaseException as error:  # noqa: BLE001  (a student's sys.exit() must not end the kernel)
            reply = {"status": "error", **_describe(error)}
        self._kernel.session.send(
            stream, REPLY, reply, parent=message, ident=identity, buffers=buffers
        )

    def _call(self, function: str, args: tuple[object, ...]) -> object:
        try:
            found = self._kernel.shell.user_ns[function]
        except KeyError:
            raise _MissingError(function) from None
        return found(*args)

    def _names(self) -> list[str]:
        names = self._kernel.shell.user_ns
        return sorted(name for name, value in list(names.items()) if callable(value))[:5000]


class _MissingError(Exception):
    """The notebook has no such function."""


def _describe(error: BaseException) -> dict[str, object]:
    """Say what went wrong, and in which line of the student's own code."""
    try:
        message = str(error)[:_MOST_MESSAGE]
    except Exception:  # noqa: BLE001  (an exception's __str__ may raise)
        message = ""
    line, number = "", 0
    for frame in traceback.extract_tb(error.__traceback__):
        if "ipykernel_" in frame.filename or "ipython-input" in frame.filename:
            line, number = (frame.line or "")[:300], frame.lineno or 0
    kinds = [kind.__name__ for kind in type(error).__mro__]
    return {"type": type(error).__name__[:200], "kinds": kinds[:20], "message": message} | {
        "line": line,
        "number": number,
    }


def _files(folder: str) -> dict[str, tuple[bytes, bool]]:
    """Give the regular files below a folder, and whether they may be executed."""
    found: dict[str, tuple[bytes, bool]] = {}
    left = _MOST_FILES_BYTES  # a recording in the package must not keep all else from being read
    # Hundreds of frames in the package must not keep its package.xml from being read, either.
    found_there = sorted(Path(folder).rglob("*"))
    for path in sorted(found_there, key=lambda path: path.suffix.lower() not in _TEXTS):
        status = path.lstat()
        if stat.S_ISREG(status.st_mode) and status.st_size <= min(left, _MOST_FILE_BYTES):
            name = path.relative_to(folder).as_posix()
            found[name] = (path.read_bytes(), bool(status.st_mode & stat.S_IXUSR))
            left -= status.st_size
        if len(found) >= _MOST_FILES:
            break
    return found


def _run_node(
    path: str,
    stamps: list[int],
    frames: list[bytes],
    topic: str,
    params: dict[str, object],
    remap: dict[str, str],
    given: list[str],
    files: dict[str, bytes],
    timeout: float,
    ros: bool,  # noqa: FBT001  (arguments come by name)
) -> dict[str, object]:
    """Run a ROS node on some pictures, in a process of its own; say what it published."""
    from course_lib.grading import node_run  # noqa: PLC0415  (only a kernel has use for it)

    for name, data in files.items():
        target = Path(name)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(data)
    return node_run.run(path, stamps, frames, topic, params, remap, given, timeout, ros=ros)
