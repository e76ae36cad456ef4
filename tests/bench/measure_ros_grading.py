"""
Grade the samples of Exercise 4.2 twice, nodes on `offline_ros` and on real ROS; compare the points.

    python tests/bench/measure_ros_grading.py [--out FOLDER] [--sample KIND/NAME …]

Both gradings use one seed, so every test asks the same. With --out, what was graded is kept there,
and a second call goes on where the first was stopped.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path.append(str(Path(__file__).parents[1] / "grading" / "samples"))

import build

SEED = "one seed for both gradings\n"
WAYS = {"offline": (), "ros": ("--ros",)}


def samples() -> list[str]:
    """List what hands in something for Exercise 4.2 and is expected to be graded as usual."""
    found = [name for kind in ("correct", "mistakes") for name in build.names(kind)]
    return [name for name in found if "4.2" in build.expected(name)["exercises"]]


def grade(folder: Path, way: str) -> None:
    """Grade the class, with the progress bar of `course grade`."""
    command = [Path(sys.executable).with_name("course"), "grade", folder / "class"]
    command += ["--out", folder / way, "--exercise", "4.2", "--seed-file", folder / "seed"]
    command += ["--sandbox", "bubblewrap", *WAYS[way]]
    subprocess.run(command, check=False)  # its status is 1 where one could not be graded


def points(folder: Path, student: str) -> dict[str, float]:
    """Read a student's points, test by test."""
    result = json.loads((folder / student / "results.json").read_bytes())
    return {test["number"]: test["score"] for test in result["tests"]}


def compare(folder: Path, names: list[str]) -> int:
    """Print who has other points on ROS; return how many."""
    unequal = 0
    for name in names:
        student = name.replace("/", "-")
        offline, on_ros = (points(folder / way, student) for way in WAYS)
        if offline != on_ros:
            unequal += 1
            keys = sorted(offline.keys() | on_ros.keys())
            differ = [k for k in keys if offline.get(k) != on_ros.get(k)]
            print(
                f"{name}: " + ", ".join(f"{k} {offline.get(k)} → {on_ros.get(k)}" for k in differ)
            )
    print(f"{len(names) - unequal} of {len(names)} have equal points in every test")
    return unequal


def main() -> int:
    """Grade and compare; exit status 1 when points differ."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument("--out", type=Path, help="keep the gradings in this folder")
    parser.add_argument("--sample", nargs="*", default=[], help="only these (default: all)")
    options = parser.parse_args()
    names = options.sample or samples()
    with TemporaryDirectory() as scratch:
        folder = (options.out or Path(scratch)).resolve()
        if not (folder / "class").exists():
            for name in names:
                build.build(name, folder / "class" / name.replace("/", "-"))
            (folder / "seed").write_text(SEED)
            (folder / "seed").chmod(0o600)
        for way in WAYS:
            grade(folder, way)
        return int(compare(folder, names) > 0)


if __name__ == "__main__":
    sys.exit(main())
