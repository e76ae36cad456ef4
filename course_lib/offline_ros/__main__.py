"""Command line: `python -m course_lib.offline_ros NODE.py [name:=value ...]`."""

from __future__ import annotations

import argparse
import os
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console as Terminal
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from course_lib.offline_ros.bag import BagSource
from course_lib.offline_ros.errors import BagError
from course_lib.offline_ros.flown import DRONE, SECONDS, DroneSource
from course_lib.offline_ros.host import Host, Limits
from course_lib.offline_ros.names import parse_value

if TYPE_CHECKING:
    from course_lib.offline_ros.runtime import Runtime
    from course_lib.offline_ros.source import Source

_EPILOG = """\
arguments for the node, as on ROS:
  topic:=other      use another topic
  _param:=value     set the node's private parameter
  __name:=value     name the node

exit status: 0 the node ended, 1 it crashed, 2 wrong usage or bag, 3 it had to be stopped
"""


def _positive(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if not number > 0:
        msg = f"{text!r} is not a positive number"
        raise argparse.ArgumentTypeError(msg)
    return number


def _rate(text: str) -> float | None:
    return None if text == "max" else _positive(text)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m course_lib.offline_ros",
        description="Run an unchanged ROS 1 node on a recording, where no ROS is installed.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("node", type=Path, metavar="NODE.py", help="the node's file")
    add("arguments", nargs="*", metavar="name:=value", help="remaps and parameters (see below)")
    add("--bag", default="flight.bag", metavar="FILE", help="the recording (default: %(default)s)")
    add(
        "--drone",
        action="store_const",
        dest="bag",
        const=DRONE,
        help=f"the simulated drone instead, which obeys /cmd_vel; {SECONDS:g} s, or --duration",
    )
    add("--heading", type=float, metavar="DEG", help="where the drone looks at first, from east")
    add(
        "--rate",
        type=_rate,
        default=None,
        metavar="HZ|max",
        help="pictures per second of wall clock, a slow node misses some; "
        "max: every picture, as quick as the node allows (default)",
    )
    add("--duration", type=_positive, metavar="SECONDS", help="stop after this much recorded time")
    add("--max-frames", type=int, metavar="N", help="stop after N pictures")
    add("--topic", action="append", metavar="TOPIC", help="play only this topic (repeatable)")
    add("--record", type=Path, metavar="OUT.bag|DIR", help="keep what the node publishes")
    add("--keep-going", action="store_true", help="log an error in a callback and go on, as ROS")
    add("--timeout", type=_positive, metavar="SECONDS", help="stop after this much wall time")
    add(
        "--stall",
        type=float,
        default=60.0,
        metavar="SECONDS",
        help="stop a node that shows no sign of life for this long (default: %(default)g)",
    )
    add("--keep", action="append", metavar="TOPIC", help="record only this topic (repeatable)")
    add("--quiet", action="store_true", help="no progress bar and no summary")
    add("--with-parent", action="store_true", help=argparse.SUPPRESS)
    add("--progress", type=Path, help=argparse.SUPPRESS)
    # So that an option of the node is not taken for one of this command.
    add("--argument", action="append", default=[], help=argparse.SUPPRESS)
    add("--shared", action="append", default=[], help=argparse.SUPPRESS)
    return parser


def _source(options: argparse.Namespace) -> Source:
    wanted = {"topics": options.topic, "max_frames": options.max_frames}
    if options.bag == DRONE and not Path(DRONE).exists():
        return DroneSource(**wanted, seconds=options.duration, heading=options.heading)
    return BagSource(options.bag, **wanted)


def _show_progress(runtime: Runtime, done: threading.Event) -> None:
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(
        *columns, TimeRemainingColumn(), console=Terminal(stderr=True), transient=True
    ) as bar:
        task = bar.add_task("pictures", total=runtime.source.frame_count or None)
        while not done.wait(0.2):
            bar.update(task, completed=runtime.frames)


def main(argv: list[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    argv : list of str, optional
        Its arguments. Default: those of the process.

    Returns
    -------
    int
        Exit status.
    """
    parser = _parser()
    options = parser.parse_intermixed_args(argv)
    if not options.node.is_file():
        parser.error(f"there is no node file {options.node}")
    record: Path | None = options.record
    if record is not None and (record.is_dir() or record.suffix != ".bag"):
        record.mkdir(parents=True, exist_ok=True)
        record /= f"{options.node.stem}.bag"
    try:
        source = _source(options)
    except (BagError, ValueError) as error:
        parser.error(str(error))
    if options.rate and not source.rate:
        parser.error(f"--rate counts pictures, but {source.path.name} has fewer than two")
    if record is not None and record.resolve() == source.path:
        parser.error("--record would overwrite the recording that is played")
    host = Host(
        options.node,
        [*options.argument, *options.arguments],
        source,
        record=record,
        keep=options.keep,
        limits=Limits(
            options.timeout, options.stall or None, options.with_parent, options.progress
        ),
        rate=options.rate,
        duration=options.duration,
        keep_going=options.keep_going,
    )
    for pair in options.shared:
        name, _, value = pair.partition(":=")
        host.runtime.parameters[name] = parse_value(value)
    done = threading.Event()
    bar = threading.Thread(target=_show_progress, args=(host.runtime, done), daemon=True)
    if not options.quiet and sys.stderr.isatty():
        bar.start()
    status = host.run()
    done.set()
    if bar.is_alive():
        bar.join()
    if not options.quiet:
        print(host.summary(), file=sys.stderr)  # noqa: T201  (this is a command)
    return status


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    sys.stderr.flush()
    # Threads of the node that never end must not keep the process alive.
    os._exit(code)
