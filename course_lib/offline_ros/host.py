"""Runs a node file in this process, from its first line to its end."""

from __future__ import annotations

import json
import os
import runpy
import signal
import sys
import threading
import time
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.offline_ros.console import Console
from course_lib.offline_ros.errors import BagError
from course_lib.offline_ros.exceptions import ROSInterruptException
from course_lib.offline_ros.install import install
from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.modules import set_runtime
from course_lib.offline_ros.names import Names, split_arguments
from course_lib.offline_ros.own_modules import own_modules
from course_lib.offline_ros.recorder import OUTCOME, Recorder
from course_lib.offline_ros.runtime import Runtime
from course_lib.offline_ros.windows import Windows

if TYPE_CHECKING:
    from collections.abc import Callable, Collection
    from types import FrameType

    from course_lib.offline_ros.source import Source

# By both of its names: the grader lays the course out by links.
_PACKAGES = (str(Path(__file__).parent), str(Path(__file__).resolve().parent))
_MOST_PRINTED = 100_000_000  # bytes
_MOST_RECORDED = 4_000_000_000
_TO_RETURN = 3.0  # wall seconds a node gets to return once it was shut down

ENDED, CRASHED, STOPPED, INTERRUPTED = "ended", "crashed", "stopped", "interrupted"
STATUS = {ENDED: 0, CRASHED: 1, STOPPED: 3, INTERRUPTED: 130}


@dataclass(frozen=True)
class Limits:
    """When a run is stopped from outside the node.

    Attributes
    ----------
    timeout : float or None
        Wall seconds for the whole run.
    stall : float or None
        Wall seconds without any sign of life: no message delivered, no waiting.
    with_parent : bool
        Stop when the process that started this one is gone.
    progress : Path or None
        A file that tells, while the node runs, how many pictures were played.
    """

    timeout: float | None = None
    stall: float | None = 60.0
    with_parent: bool = False
    progress: Path | None = None


class Host:
    """One run of one node.

    Parameters
    ----------
    node : Path
        The node's file.
    arguments : list of str
        Its command line: `name:=value` pairs and plain arguments.
    source : Source
        What is played to it.
    record : Path, optional
        The bag that keeps what it does.
    keep : collection of str, optional
        The published topics that it keeps. Default: all.
    limits : Limits
        When to stop it.
    rate, duration, keep_going : optional
        As for `Runtime`.
    """

    def __init__(
        self,
        node: Path,
        arguments: list[str],
        source: Source,
        *,
        record: Path | None = None,
        keep: Collection[str] | None = None,
        limits: Limits | None = None,
        rate: float | None = None,
        duration: float | None = None,
        keep_going: bool = False,
    ) -> None:
        self._node = node.resolve()
        self._arguments = arguments
        self._recorder = Recorder(record, keep) if record else None
        console = Console(self._recorder)
        self.runtime = Runtime(
            source,
            names=Names(split_arguments(arguments)[1]),
            console=console,
            recorder=self._recorder,
            rate=rate,
            duration=duration,
            keep_going=keep_going,
        )
        console.now_ns = self.runtime.now_ns
        self._windows = Windows(self.runtime)
        self._limits = limits or Limits()
        self._started = time.monotonic()
        self._ending: float | None = None
        self._interrupted = False
        self._finished = False
        self._closing = threading.Lock()

    def run(self) -> int:
        """Run the node to its end.

        Returns
        -------
        int
            Exit status: 0 ended, 1 crashed, 3 stopped, 130 interrupted.
        """
        install()
        set_runtime(self.runtime)
        self._windows.install()
        time.sleep = self._simulated_sleep(time.sleep)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._interrupt)
        threading.Thread(target=self._watch, daemon=True).start()
        sys.argv = [str(self._node), *self._arguments]
        if sys.flags.safe_path:
            sys.path.insert(0, str(self._node.parent))
        else:
            sys.path[0] = str(self._node.parent)
        if folder := own_modules(self._node):
            sys.path.insert(1, str(folder))
        outcome, text = self._run_file()
        if self._interrupted:
            outcome, text = INTERRUPTED, ""
        self.runtime.shutdown(f"the node has {'crashed' if outcome == CRASHED else 'returned'}")
        self._finish(outcome, text)
        return STATUS[outcome]

    def summary(self) -> str:
        """Say in a few words what happened.

        Returns
        -------
        str
            Such as "240 pictures in 9.8 s (24.5 per second), published /object/corners 240".
        """
        runtime, seconds = self.runtime, time.monotonic() - self._started
        published = ", ".join(f"{topic} {n}" for topic, n in sorted(runtime.published.items()))
        lost = f", {runtime.dropped} messages missed" if runtime.dropped else ""
        return (
            f"{runtime.frames} pictures in {seconds:.1f} s "
            f"({runtime.frames / max(seconds, 1e-9):.1f} per second){lost}, "
            f"published {published or 'nothing'}"
        )

    def _run_file(self) -> tuple[str, str]:
        try:
            runpy.run_path(str(self._node), run_name="__main__")
        except BaseException as error:  # noqa: BLE001  (whatever a node raises is its end)
            return self._judge(error)
        return ENDED, ""

    def _judge(self, error: BaseException) -> tuple[str, str]:
        """Say what it means that a node ends with this exception."""
        if isinstance(error, SystemExit):
            if not error.code:
                return ENDED, ""
            return CRASHED, f"the node left with sys.exit({error.code!r})"
        if isinstance(error, ROSInterruptException) and self.runtime.reason:
            return ENDED, ""  # waiting when it was shut down, and it did not mind
        if isinstance(error, BagError):
            return STOPPED, str(error)
        return CRASHED, node_traceback(error, self._node.parent)

    def _finish(self, outcome: str, text: str) -> None:
        """Write the end of the recording; the first of node and watchdog to come here does it."""
        with self._closing:
            if self._finished:
                return
            self._finished = True
            if missing := self.runtime.wanted - self.runtime.heard:
                played = ", ".join(sorted(self.runtime.source.topics))
                note = f"nothing came on {', '.join(sorted(missing))}; the recording plays {played}"
                print(f"offline_ros: {note}", file=sys.stderr)  # noqa: T201
            if text:
                print(text, file=sys.stderr)  # noqa: T201  (for whoever runs the node)
            runtime = self.runtime
            if self._recorder:
                self._windows.record(self._recorder)
                facts: dict[str, Any] = {
                    "kind": outcome,
                    "reason": runtime.reason,
                    "text": text,
                    "frames": runtime.frames,
                    "dropped": runtime.dropped,
                    "seconds": round(time.monotonic() - self._started, 3),
                }
                message = message_class("std_msgs/String")(data=json.dumps(facts))
                self._recorder.write_message(OUTCOME, runtime.now_ns(), message)
                self._recorder.close()
            sys.stdout.flush()
            sys.stderr.flush()

    # Outside the node's own flow

    def _simulated_sleep(self, real: Callable[[Any], None]) -> Callable[[Any], None]:
        folder = str(self._node.parent)

        def sleep(seconds: float) -> None:
            caller = str(sys._getframe(1).f_globals.get("__file__", ""))  # noqa: SLF001
            runtime = self.runtime
            if runtime.initialized and not runtime.reason and caller.startswith(folder):
                runtime.run_until(runtime.now_ns() + int(seconds * 1e9))
            else:
                real(seconds)

        return sleep

    def _interrupt(self, _number: int, _frame: FrameType | None) -> None:
        if self._ending is not None:
            _leave(INTERRUPTED)
        self._ending = time.monotonic()
        self._interrupted = True
        raise KeyboardInterrupt

    def _watch(self) -> None:
        """End a node that does not end by itself."""
        parent = os.getppid()
        moves, alive = -1, time.monotonic()
        pause = threading.Event()
        while not pause.wait(0.2) and not self._finished:
            now = time.monotonic()
            if self._limits.progress:
                self._limits.progress.write_text(str(self.runtime.frames))
            if self.runtime.moves != moves:
                moves, alive = self.runtime.moves, now
            if self.runtime.reason and self._ending is None:
                self._ending = now
            limits = self._limits
            if limits.with_parent and os.getppid() != parent:
                _leave(STOPPED)
            if self._ending is not None and now - self._ending > _TO_RETURN:
                # ROS would kill it; all it published is recorded.
                self._stop(ENDED, "the node did not return when it was shut down; it was stopped")
            elif limits.timeout is not None and now - self._started > limits.timeout:
                self._stop(STOPPED, f"the node still ran after {limits.timeout:g} s")
            elif excess := self._excess():
                self._stop(STOPPED, excess)
            elif limits.stall is not None and now - alive > limits.stall:
                self._stop(
                    STOPPED,
                    f"the node has waited for nothing in {limits.stall:g} s: no message can "
                    "arrive before it calls rospy.spin(), rate.sleep() or rospy.sleep()",
                )

    def _excess(self) -> str:
        """Say what the node has too much of: an endless loop must not fill the disk."""
        printed = os.fstat(1)
        if self._limits.with_parent and printed.st_size > _MOST_PRINTED:
            return f"the node printed more than {_MOST_PRINTED // 10**6} MB"
        if self._recorder and self._recorder.path.stat().st_size > _MOST_RECORDED:
            return f"the node published more than {_MOST_RECORDED // 10**9} GB"
        return ""

    def _stop(self, outcome: str, text: str) -> None:
        frame = sys._current_frames().get(threading.main_thread().ident or 0)  # noqa: SLF001
        stack = [f for f in traceback.extract_stack(frame) if _is_nodes(f.filename)]
        where = _from_folder("".join(traceback.format_list(stack)), self._node.parent)
        self._finish(outcome, f"{text}. It was here:\n{where}" if where else text)
        _leave(outcome)


def _leave(outcome: str) -> None:
    if sys.stderr.isatty():
        os.write(2, b"\033[?25h")  # a progress bar has hidden the cursor
    os._exit(STATUS[outcome])


def _is_nodes(filename: str) -> bool:
    return not filename.startswith((*_PACKAGES, "<frozen"))


def node_traceback(error: BaseException, folder: Path) -> str:
    """Format a traceback without the lines of this package.

    Parameters
    ----------
    error : BaseException
        What the node raised.
    folder : Path
        Where the node is; its files are named from there, so that the text is the same anywhere.

    Returns
    -------
    str
        As Python prints it, with only the node's own lines and its libraries'.
    """
    summary = traceback.TracebackException.from_exception(error)
    link: traceback.TracebackException | None = summary
    while link is not None:
        link.stack = traceback.StackSummary.from_list(
            [frame for frame in link.stack if _is_nodes(frame.filename)]
        )
        link = link.__cause__ or link.__context__
    return _from_folder("".join(summary.format()).rstrip(), folder)


def _from_folder(text: str, folder: Path) -> str:
    return text.replace(f'File "{folder}{os.sep}', 'File "')
