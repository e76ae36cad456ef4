"""Writes a recording's compressed pictures as a camera publishes them, for `rosbag play`.

::

    python -m course_lib.real_ros.raw build/flight_raw.bag
    python -m course_lib.real_ros.raw short.bag --bag flight.bag --max-frames 50
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from course_lib.offline_ros.bag import BagSource
from course_lib.offline_ros.errors import BagError
from course_lib.offline_ros.recorder import Recorder


def write_raw(bag: str | Path, target: Path, *, max_frames: int | None = None) -> int:
    """Copy the busiest camera topic of a recording into a ROS 1 bag, its pictures decompressed.

    Parameters
    ----------
    bag : str or Path
        A ROS 1 or ROS 2 bag, by path or by the course's name for it.
    target : Path
        The bag to write; replaced if it exists.
    max_frames : int, optional
        Stop after so many pictures.

    Returns
    -------
    int
        How many pictures it holds.

    Raises
    ------
    BagError
        When the bag is missing, unreadable or has no picture.
    """
    camera = BagSource(bag).camera
    if camera is None:
        raise BagError(f"{bag} holds no picture")
    recorder, count = Recorder(target), 0
    for arrival in BagSource(bag, topics=[camera], max_frames=max_frames):
        recorder.write_message(arrival.topic, arrival.stamp_ns, arrival.load())
        count += 1
    recorder.close()
    return count


def main(arguments: list[str] | None = None) -> int:
    """Run the command; return its exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m course_lib.real_ros.raw",
        description="Write a recording's pictures uncompressed, for rosbag play.",
    )
    parser.add_argument("target", type=Path, metavar="RAW.bag", help="the bag to write")
    parser.add_argument("--bag", default="flight.bag", metavar="FILE", help="(%(default)s)")
    parser.add_argument("--max-frames", type=int, metavar="N", help="stop after N pictures")
    options = parser.parse_args(arguments)
    options.target.parent.mkdir(parents=True, exist_ok=True)
    try:
        count = write_raw(options.bag, options.target, max_frames=options.max_frames)
    except (BagError, ValueError) as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    print(f"{options.target}: {count} pictures")  # noqa: T201  (this is a command)
    return 0


if __name__ == "__main__":
    sys.exit(main())
