"""
On real ROS, camera to corners: our node of Example 4.5 against the unit's own callback.

Latency: a picture is published when the one before has been answered; the time until all answers
to it have come back. Frames per second: pictures are published faster than any node can answer,
and the answers are counted. Both nodes are started by roslaunch in the same run, in interleaved
rounds; medians are compared.

    python tests/bench/bench_ros.py [--frames N] [--rounds N]
"""

from __future__ import annotations

import argparse
import statistics
from pathlib import Path
from tempfile import TemporaryDirectory

from course_lib.real_ros import complaint, run_launch
from course_lib.real_ros.raw import write_raw

HERE = Path(__file__).resolve().parent
UNIT4 = HERE.parents[1] / "solutions" / "unit4"
TEMPLATE = str(UNIT4 / "waterhole.png")
NODES = {
    "Example 4.5": (HERE / "unit45", "callback.launch"),
    "ours": (UNIT4, "example4_5.launch"),
}
TOPICS = ["/object/corners", "/object/image"]
TOO_FAST = 120.0  # pictures per second


def measure(package, launch, bag):
    """Give the median latency in ms, and the answers per second of a node that is flooded."""
    arguments = {"template": TEMPLATE}
    calm = run_launch(package, launch, bag=bag, arguments=arguments, keep=TOPICS[:1])
    flooded = run_launch(
        package, launch, bag=bag, arguments=arguments, keep=TOPICS[:1], rate=TOO_FAST
    )
    answers = len(flooded[TOPICS[0]])
    latency = 1000 * statistics.median(calm.outcome["latencies"])
    return latency, (answers - 1) / flooded.outcome["answering"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().split("\n\n")[0])
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    if problem := complaint():
        print(f"Not measured: {problem}")
        return
    rounds = {name: [] for name in NODES}
    with TemporaryDirectory() as folder:
        bag = Path(folder) / "raw.bag"
        write_raw("flight.bag", bag, max_frames=options.frames)
        for _ in range(options.rounds):
            for name, (package, launch) in NODES.items():
                rounds[name].append(measure(package, launch, bag))
    print(f"{options.frames} frames of flight.bag, {options.rounds} rounds, medians")
    for name, values in rounds.items():
        latency, speed = (statistics.median(column) for column in zip(*values, strict=True))
        print(f"{name:12s} {latency:7.1f} ms camera to corners   {speed:6.1f} frames/s")
    pairs = list(zip(*rounds.values(), strict=True))
    slower = statistics.median(unit[0] / ours[0] for unit, ours in pairs)
    faster = statistics.median(ours[1] / unit[1] for unit, ours in pairs)
    print(f"ratio        {slower:7.2f} × sooner                 {faster:6.2f} × as many")


if __name__ == "__main__":
    main()
