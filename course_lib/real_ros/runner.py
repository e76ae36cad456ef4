"""Plays a recording to what a launch file starts on real ROS."""

from __future__ import annotations

import contextlib
import re
import signal
import struct
import threading
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape, quoteattr

from course_lib.offline_ros.bag import BagSource
from course_lib.offline_ros.errors import BagError, NodeError
from course_lib.offline_ros.names import as_yaml
from course_lib.offline_ros.own_modules import own_modules
from course_lib.offline_ros.recording import Recording
from course_lib.offline_ros.wire import serialize
from course_lib.real_ros.core import Ros
from course_lib.real_ros.system import PYTHON

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from course_lib.real_ros.processes import Program

_PLAYER = Path(__file__).with_name("player.py")
_HEAD = struct.Struct("<QHHI")  # as in `player`
_DIED = re.compile(r"\[(\S+?)(?:-\d+)?\] process has died \[pid \d+, exit code (-?\d+)")


def run_launch(
    package: str | Path,
    launch: str | Path,
    *,
    bag: str | Path = "flight.bag",
    arguments: Mapping[str, str] | None = None,
    params: Mapping[str, Any] | None = None,
    topics: Collection[str] | None = None,
    keep: Collection[str] | None = None,
    max_frames: int | None = None,
    rate: float | None = None,
    keep_going: bool = False,
    timeout: float = 120.0,
    home: str | Path | None = None,
) -> Recording:
    """Run a launch file with real `roslaunch` on a recording and give back what its nodes did.

    Parameters
    ----------
    package : str or Path
        The package's folder, such as ``solutions/unit4``.
    launch : str or Path
        The launch file's name, in the package's folder ``launch``; or a path.
    bag : str or Path, optional
        A ROS 1 or ROS 2 bag, by path or by the course's name for it.
    arguments : mapping of str to str, optional
        For the launch file: ``{"template": "well.png"}`` is ``template:=well.png``.
    params : mapping, optional
        Private parameters for each of its nodes, which replace those of the launch file.
    topics, keep, max_frames, keep_going : optional
        As for `offline_ros.run_node`.
    rate : float, optional
        Pictures per second; a node that is slower misses some. Default: each picture when the one
        before it has been dealt with.
    timeout : float, optional
        Wall seconds after which it is stopped.
    home : str or Path, optional
        Where the nodes run; `$(env HOME)` is this folder too. Default: a temporary one.

    Returns
    -------
    Recording
        Published messages by topic, and log lines, as of `offline_ros.run_node`. `outcome` has
        `latencies` too, seconds from each picture to its last answer, and `answering`, seconds
        from the first answer to the last.

    Raises
    ------
    NodeError
        When the launch file does not start, or a node died or had to be stopped; it carries what
        was recorded until then.
    BagError
        When the bag is missing, unreadable or has none of these topics.
    RosError
        When ROS is not installed or itself fails.
    """
    began = time.monotonic()
    folder = Path(package).resolve()
    file = folder / "launch" / launch
    source = BagSource(bag, topics=topics, max_frames=max_frames)
    scratch = TemporaryDirectory(prefix="real_ros_")
    record = Path(scratch.name, "recording.bag")
    options = [f"--record={record}", f"--rate={rate or 0}"]
    options += [f"--keep={topic}" for topic in keep or ()]
    options += ["--keep-going"] * keep_going
    with Ros(folder.parent, home=home, sim_time=True) as ros:
        if modules := own_modules(folder):  # nothing is built here
            ros.environment["PYTHONPATH"] = str(modules)
        target = _with_params(ros, file, params or {}, Path(scratch.name))
        given = [f"{name}:={value}" for name, value in (arguments or {}).items()]
        player = ros.start(str(PYTHON), str(_PLAYER), *options, feed=True)
        threading.Thread(target=_feed, args=(source, player), daemon=True).start()
        quickly = ("--screen", "--skip-log-check", "--sigint-timeout=3")
        nodes = ros.start("roslaunch", *quickly, str(target), *given)
        problem = _watch(player, nodes, began + timeout)
        if problem:
            problem = f"{problem} after {timeout:g} s"
        status, output = nodes.end(), nodes.output
    return _judge(record, scratch, output, problem or _failure(status, output, file.name))


def _with_params(ros: Ros, file: Path, params: Mapping[str, Any], scratch: Path) -> Path:
    """Give a launch file that sets the nodes' parameters last; the same if there are none."""
    if not params:
        return file
    listing = ros.start("roslaunch", "--nodes", str(file))
    if listing.wait(60):
        raise NodeError(f"{file.name} does not start", traceback=listing.output)
    names = [line.strip() for line in listing.output.splitlines() if line.startswith("/")]
    # Of what sets a parameter twice, roslaunch takes the last.
    lines = [f"<include file={quoteattr(str(file))} pass_all_args='true'/>"]
    lines += [rosparam(f"{node}/{name}", value) for node in names for name, value in params.items()]
    wrapper = scratch / file.name
    wrapper.write_text("\n".join(["<launch>", *lines, "</launch>", ""]))
    return wrapper


def rosparam(name: str, value: object) -> str:
    """Write a launch file's element that sets a parameter, and keeps the value's type."""
    return f"<rosparam param={quoteattr(name)}>{escape(as_yaml(value))}</rosparam>"


def _feed(source: BagSource, player: Program) -> None:
    """Send the recording's messages; a player that has had enough hangs up."""
    pipe = player.process.stdin
    if pipe is None:  # no pipe was asked for
        return
    with contextlib.suppress(OSError, ValueError):
        for arrival in source:
            data = serialize(arrival.load())
            topic, kind = arrival.topic.encode(), arrival.msgtype.encode()
            head = _HEAD.pack(arrival.stamp_ns, len(topic), len(kind), len(data))
            pipe.write(b"".join([head, topic, kind, data]))
    with contextlib.suppress(OSError, ValueError):
        pipe.close()


def _watch(player: Program, nodes: Program, deadline: float) -> str:
    """Wait until the player has finished; say what kept it from it."""
    while player.status is None:
        if nodes.status is not None:
            player.end(signal.SIGINT)  # nobody is left to play to
            return ""
        if time.monotonic() > deadline:
            player.end(signal.SIGINT)
            return "the nodes still ran"
        time.sleep(0.02)
    return ""


def _failure(status: int, output: str, launch: str) -> str:
    """Say what roslaunch itself calls a failure; a node that ended with an error is one."""
    if found := _DIED.search(output):
        return f"{found[1]} has died, exit code {found[2]}"
    if status and "started with pid" not in output:
        return f"{launch} does not start"
    return ""


def _judge(record: Path, scratch: TemporaryDirectory[str], output: str, problem: str) -> Recording:
    try:
        recording = Recording(record, output=output, folder=scratch)
    except BagError as error:
        raise NodeError(problem or "nothing was recorded", traceback=output) from error
    outcome = recording.outcome
    if outcome.get("kind") != "ended":
        problem = problem or str(outcome.get("reason", ""))
        raise NodeError(problem, traceback=str(outcome.get("text", "")), recording=recording)
    if problem:
        raise NodeError(problem, traceback=output, recording=recording)
    return recording
