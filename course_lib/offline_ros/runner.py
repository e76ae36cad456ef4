"""Runs a node from a notebook: in its own process, with data coming back as a bag."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from course_lib.offline_ros.bag import find_bag
from course_lib.offline_ros.errors import BagError, NodeError
from course_lib.offline_ros.flown import DRONE
from course_lib.offline_ros.host import CRASHED, ENDED
from course_lib.offline_ros.names import as_yaml
from course_lib.offline_ros.recording import Recording

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

_ROOT = Path(__file__).resolve().parents[2]
_MOST_OUTPUT = 1_000_000  # bytes of printed text that are kept, from the end


def run_node(
    path: str | Path,
    *,
    bag: str | Path = "flight.bag",
    remap: Mapping[str, str] | None = None,
    params: Mapping[str, Any] | None = None,
    arguments: Sequence[str] = (),
    topics: Collection[str] | None = None,
    timeout: float | None = None,
    max_frames: int | None = None,
    rate: float | None = None,
    duration: float | None = None,
    keep_going: bool = False,
    stall: float | None = 60.0,
    keep: Collection[str] | None = None,
    progress: bool = False,
) -> Recording:
    """Run a ROS 1 node file on a recording and give back what it did.

    The node runs in a process of its own, so its endless loops, signal handlers and global
    state stay out of this one. By default time is simulated: every message is delivered, in
    order, and two runs give the same result whatever the machine's speed.

    Parameters
    ----------
    path : str or Path
        The node's file.
    bag : str or Path, optional
        A ROS 1 or ROS 2 bag, by path or by the course's name for it, or "drone": the simulated
        drone, which obeys what the node publishes on `/cmd_vel`.
    remap : mapping of str to str, optional
        Topics to rename, `{"/camera/image": "/camera/rgb/image_raw"}`.
    params : mapping of str to object, optional
        The node's private parameters, `{"match_count": 100}`; others begin with a slash.
    arguments : sequence of str, optional
        What else stands on its command line, `["--match-count", "100"]`.
    topics : collection of str, optional
        Play only these. Default: all.
    timeout : float, optional
        Wall seconds after which the node is stopped. Default: no limit.
    max_frames : int, optional
        Play only so many pictures.
    rate : float, optional
        Pictures per second of wall clock; a node that is slower misses some, as on a robot.
        Default: as quick as the node allows, and it misses none.
    duration : float, optional
        Simulated seconds after which the node is shut down. Default: one second after the
        last message.
    keep_going : bool, optional
        Log an exception in a callback and go on, as ROS does. Default: stop there.
    stall : float, optional
        Wall seconds without a sign of life after which the node is stopped.
    keep : collection of str, optional
        The published topics that the recording keeps. Default: all; leave out pictures you do
        not need, each takes a megabyte or so.
    progress : bool, optional
        Say on stderr how many pictures were played.

    Returns
    -------
    Recording
        Published messages by topic, log lines, windows.

    Raises
    ------
    FileNotFoundError
        When there is no such node file.
    ValueError
        When a limit is not positive.
    BagError
        When the bag is missing, unreadable or has none of these topics.
    NodeError
        When the node crashed or had to be stopped; it carries what was recorded until then.
    """
    node = Path(path)
    if not node.is_file():
        msg = f"there is no node file {node}"
        raise FileNotFoundError(msg)
    limits = {
        "timeout": timeout,
        "max-frames": max_frames,
        "rate": rate,
        "duration": duration,
    }
    options = [
        "--quiet",
        "--with-parent",
        f"--bag={bag if bag == DRONE else find_bag(bag)}",
        f"--stall={stall or 0}",
    ]
    options += _limits(limits)
    options += [f"--topic={topic}" for topic in topics or ()]
    options += [f"--keep={topic}" for topic in keep or ()]
    options += [f"--argument={argument}" for argument in arguments]
    if keep_going:
        options.append("--keep-going")

    folder = TemporaryDirectory(prefix="offline_ros_")
    record = Path(folder.name) / "recording.bag"
    printed = Path(folder.name) / "output.txt"
    played = Path(folder.name) / "played.txt" if progress else None
    if played:
        options.append(f"--progress={played}")
    given = [f"{left}:={right}" for left, right in (remap or {}).items()]
    for name, value in (params or {}).items():
        if name.startswith("/"):
            options.append(f"--param={name}:={as_yaml(value)}")
        else:
            given.append(f"_{name.lstrip('~_')}:={as_yaml(value)}")
    # -P: what lies beside a notebook, such as its own random.py, is no module on a robot either.
    command = [sys.executable, "-P", "-m", "course_lib.offline_ros", f"--record={record}", *options]
    status = _run([*command, str(node), *given], printed, played)
    output = _tail(printed)
    if status == 2 and not record.exists():
        raise BagError(output.rpartition("error: ")[2].strip())
    try:
        recording = Recording(record, output=output, folder=folder)
    except BagError as error:
        how = f"by signal {-status}" if status < 0 else f"with status {status}"
        msg = f"{node.name} was ended {how} before it could be recorded"
        raise NodeError(msg, traceback=output) from error
    kind = recording.outcome.get("kind")
    if kind != ENDED:
        verb = "crashed" if kind == CRASHED else f"was {kind}"
        raise NodeError(
            f"{node.name} {verb}", traceback=recording.outcome["text"], recording=recording
        )
    return recording


def _limits(limits: Mapping[str, float | None]) -> list[str]:
    for name, value in limits.items():
        if value is not None and not value > 0:
            msg = f"{name.replace('-', '_')} must be positive, not {value}"
            raise ValueError(msg)
    return [f"--{name}={value}" for name, value in limits.items() if value is not None]


def _tail(printed: Path) -> str:
    with printed.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(0, size - _MOST_OUTPUT))
        return file.read().decode(errors="replace")


def _report(played: Path, status: int = 0) -> int:
    with suppress(OSError):
        print(f"\r{played.read_text()} pictures", end="", file=sys.stderr, flush=True)  # noqa: T201
    return status


def _run(command: list[str], printed: Path, played: Path | None) -> int:
    environment = dict(os.environ)
    paths = [str(_ROOT), environment.get("PYTHONPATH", "")]
    environment["PYTHONPATH"] = os.pathsep.join(filter(None, paths))
    environment |= {"PYTHONUNBUFFERED": "1", "PYTHONIOENCODING": "utf-8"}
    # A kernel's inline backend does not work outside it.
    environment["MPLBACKEND"] = "Agg"
    with printed.open("wb") as output:
        # A session of its own: an interrupt reaches this process alone, and it ends the whole
        # group, the node's own children included.
        process = subprocess.Popen(  # noqa: S603  (the node is what the caller wants to run)
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            env=environment,
            start_new_session=True,
        )
        try:
            while played:
                with suppress(subprocess.TimeoutExpired):
                    return _report(played, process.wait(0.5))
                _report(played)
            return process.wait()
        except BaseException:
            process.terminate()
            try:
                process.wait(3)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            raise
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
