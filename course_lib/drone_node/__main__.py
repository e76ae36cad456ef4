"""Command line: `python -m course_lib.drone_node [name:=value ...]`."""

from __future__ import annotations

import argparse
import json
import signal
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.drone import START, Drone, RendererError
from course_lib.drone_node import ros_python

if TYPE_CHECKING:
    from collections.abc import Iterator

TIMEOUT = 0.5  # seconds after the last command until it hovers
COMMAND = struct.Struct("<4d")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m course_lib.drone_node",
        description="Fly the simulated drone under ROS 1: it obeys /cmd_vel, and hovers when no "
        f"command came for {TIMEOUT} seconds; its camera is on /camera/rgb/image_raw.",
    )
    add = parser.add_argument
    add("names", nargs="*", metavar="name:=value", help="remaps, as on ROS")
    add("--rate", type=float, default=20.0, metavar="HZ", help="pictures a second (%(default)g)")
    add("--seed", type=int, default=0, help="of its sway and its camera's noise (%(default)s)")
    add("--start", type=float, nargs=3, default=START, metavar=("X", "Y", "Z"),
        help="metres east, north and up of the well's foot")  # fmt: skip
    return parser


def _commands(link: socket.socket) -> Iterator[tuple[float, ...]]:
    """Give the commands that have come; an empty answer means that the other side has ended."""
    try:
        data = link.recv(1 << 16, socket.MSG_DONTWAIT)
    except BlockingIOError:
        return
    if not data:
        raise EOFError
    while len(data) % COMMAND.size:
        data += link.recv(COMMAND.size - len(data) % COMMAND.size)
    yield from COMMAND.iter_unpack(data)


def _send(link: socket.socket, drone: Drone) -> None:
    frame = drone.frame()
    truth = frame.truth or {}
    height, width = frame.image.shape[:2]
    about = json.dumps(
        {
            "width": width,
            "height": height,
            "K": truth["camera"]["K"],
            "well": truth["well"]["polygon"],
            "position": drone.position.tolist(),
            "heading": drone.heading,
        }
    ).encode()
    pixels = frame.image.tobytes()
    link.sendall(struct.pack("<II", len(about), len(pixels)) + about + pixels)


def fly(drone: Drone, link: socket.socket, rate: float) -> None:
    """Fly at the clock's pace and send pictures until the other side ends.

    Parameters
    ----------
    drone : Drone
    link : socket
        To the ROS side.
    rate : float
        Pictures per second; a machine that is too slow sends fewer, and time still keeps pace.

    Raises
    ------
    EOFError, OSError
        The other side has ended.
    """
    flown, due = time.monotonic(), time.monotonic()
    while True:
        for command in _commands(link):
            drone.command(*command)
        now = time.monotonic()
        drone.step(now - flown)
        flown = now
        _send(link, drone)
        due = max(due + 1 / rate, time.monotonic() - 1 / rate)
        time.sleep(max(0.0, due - time.monotonic()))


def main(argv: list[str] | None = None) -> int:
    """Run the node; return its exit status.

    Parameters
    ----------
    argv : list of str, optional
        Default: the process's own.
    """
    parser = _parser()
    options = parser.parse_intermixed_args(argv)
    if not options.rate > 0:
        parser.error("--rate must be positive")
    try:
        python = ros_python.find()
        drone = Drone(options.seed, position=tuple(options.start), command_timeout=TIMEOUT)
    except (RendererError, ros_python.NoRosError) as error:
        print(error, file=sys.stderr)  # noqa: T201
        return 1
    ours, theirs = socket.socketpair()
    ros_side = Path(__file__).with_name("ros_side.py")
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with drone, ours:
        process = subprocess.Popen(  # noqa: S603 (our own file)
            [python, str(ros_side), str(theirs.fileno()), *options.names],
            pass_fds=[theirs.fileno()],
            env=ros_python.environment(),
        )
        theirs.close()
        status = None
        try:
            fly(drone, ours, options.rate)
        except (EOFError, OSError):
            status = process.wait()
        except KeyboardInterrupt:
            status = 0
        finally:
            ours.close()
            _end(process)
    return status or 0


def _end(process: subprocess.Popen[bytes]) -> None:
    try:
        process.wait(3)
    except subprocess.TimeoutExpired:
        process.terminate()
        try:
            process.wait(3)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


if __name__ == "__main__":
    sys.exit(main())
