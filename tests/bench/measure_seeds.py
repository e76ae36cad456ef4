"""
Grade the solutions on many secret seeds: what is lost where, and how long it takes.

    python tests/bench/measure_seeds.py [--seeds N] [--first N] [--exercise 4.1 4.2] [--styles]

Honest work must get every point whatever the seed. Printed for each seed: points, seconds, and each
test that lost something, with what the student would read. `--styles` grades Exercise 4.2 as
different people did it (tests/grading/independent_4_2.py) instead of the solutions.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path.insert(0, str(Path(__file__).parents[1] / "grading"))

from hidden_runs import edited, graded
from independent_4_2 import CELLS, handed_in

from course_lib.grading.sandbox import Launcher, Limits


def cpu():
    """Seconds of processor time, of this process and of those that it has buried."""
    both = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in both)


def works(options, folder):
    """Yield the name, the exercise and the folder of what is graded."""
    if options.styles:
        for style in CELLS:
            yield style, "4.2", handed_in(style, folder / style.replace(" ", "_"))
        return
    for exercise in options.exercise:
        name = f"exercise_{exercise.replace('.', '_')}.ipynb"
        yield "solution", exercise, edited(name, folder / exercise, ())


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--exercise", nargs="+", default=["4.1", "4.2"])
    parser.add_argument("--styles", action="store_true")
    options = parser.parse_args()
    lost, runs, seconds = Counter(), 0, 0.0
    with TemporaryDirectory() as folder, Launcher("bubblewrap", Limits()) as launcher:
        for name, exercise, work in works(options, Path(folder)):
            for number in range(options.first, options.first + options.seeds):
                started, busy = time.perf_counter(), cpu()
                result = graded(work, exercise, launcher, b"measured with seed %06d" % number)
                took = time.perf_counter() - started
                runs, seconds = runs + 1, seconds + took
                print(
                    f"{name}, {exercise}, seed {number}: {result.score:g} of {result.max_score:g}, "
                    f"{took:.1f} s, of them {cpu() - busy:.1f} s of the grader's own processor",
                    flush=True,
                )
                for test in result.tests:
                    if test.score < test.max_score:
                        lost[exercise, test.number] += 1
                        print(f"    {test.number} {test.score:g}: {test.output}", flush=True)
    print(
        f"{runs} gradings, {seconds / max(runs, 1):.1f} s each; lost points: {dict(lost) or 'none'}"
    )


if __name__ == "__main__":
    main()
