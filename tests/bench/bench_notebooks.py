"""
Seconds to execute each notebook, against starting and ending a kernel with nothing to do.

Both are measured in the same run, so the ratio holds on any machine. The bar is on the clock on the
wall; only where more processes want to run than there are processors, it is on the processors'
time if that is less, since the clock then measures the others.

With --repeat, every notebook is executed that many times in a row; a cell that has not ended after
--stall seconds is reported as a stall.

    python tests/bench/bench_notebooks.py [--repeat N] [--limit S] [--stall S] [NOTEBOOK …]
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import sys
import tempfile
import time
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import nbformat
from nbformat.v4 import new_code_cell, new_notebook
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from course_lib.publish.execute import find_notebooks
from course_lib.publish.runner import NotebookFailed, run_notebook

FOLDER = Path(__file__).resolve().parents[2] / "notebooks"
EMPTY = "(empty kernel)"


@dataclass(frozen=True)
class Run:
    """Seconds of one execution: on the wall, and worked by the kernel's processors."""

    wall: float
    cpu: float


def cpu_seconds() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def execute(path: Path, stall: float) -> Run | None:
    """Run a notebook; None when a cell stalled."""
    start, cpu = time.perf_counter(), cpu_seconds()
    try:
        run_notebook(path, cell_timeout=stall)
    except NotebookFailed as error:
        if "took longer than" not in str(error):
            raise  # a notebook that is wrong has no speed
        return None
    return Run(time.perf_counter() - start, cpu_seconds() - cpu)


def report(runs: dict[str, list[Run]], stalls: dict[str, int], limit: float) -> bool:
    """Print the table; return whether every run ended within the limit."""
    if not runs[EMPTY]:
        print("nothing was measured")
        return False
    middle = {
        name: statistics.median(run.wall for run in some) for name, some in runs.items() if some
    }
    floor = middle[EMPTY]
    table = Table("notebook", "runs", "median s", "max s", "max CPU s", "× empty", "stalls")
    for name, some in runs.items():
        figures = ["–"] * 4
        if some:
            slowest, hardest = max(run.wall for run in some), max(run.cpu for run in some)
            figures = [f"{x:.2f}" for x in (middle[name], slowest, hardest)]
            figures.append(f"{middle[name] / floor:.1f}")
        table.add_row(name, str(len(some) + stalls[name]), *figures, str(stalls[name]))
    Console().print(table)
    total = sum(seconds for name, seconds in middle.items() if name != EMPTY)
    print(f"all notebooks once: {total:.1f} s, {total / floor:.1f} × one empty kernel")
    is_busy = os.getloadavg()[1] > (os.cpu_count() or 1)  # over the last five minutes
    every = [run for some in runs.values() for run in some]
    worst = max(min(run.wall, run.cpu) if is_busy else run.wall for run in every)
    if is_busy:
        print("the machine is busy: the bar is on the processors' time")
    print(f"longest run: {worst:.1f} s (bar: {limit:g} s); stalls: {sum(stalls.values())}")
    return worst <= limit and not any(stalls.values())


def main() -> int:
    """Measure; exit status 1 when a run stalled or missed the bar."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument("notebooks", nargs="*", type=Path, help="default: the course's")
    parser.add_argument("--repeat", type=int, default=1, metavar="N", help="runs of each (1)")
    parser.add_argument("--limit", type=float, default=20.0, metavar="S", help="bar (20)")
    parser.add_argument("--stall", type=float, default=120.0, metavar="S", help="per cell (120)")
    options = parser.parse_args()
    if options.repeat < 1:
        parser.error("--repeat must be at least 1")
    try:
        paths = find_notebooks(options.notebooks or [FOLDER])
    except FileNotFoundError as error:
        parser.error(str(error))

    runs: dict[str, list[Run]] = {EMPTY: []} | {path.stem: [] for path in paths}
    stalls: dict[str, int] = defaultdict(int)
    with (
        tempfile.TemporaryDirectory() as folder,
        Progress(console=Console(stderr=True), transient=True) as progress,
    ):
        empty = Path(folder) / "empty.ipynb"
        nbformat.write(new_notebook(cells=[new_code_cell("None")]), empty)
        execute(empty, options.stall)  # the first start reads files from the disk
        bar = progress.add_task("", total=options.repeat * (len(paths) + 1))
        try:
            for number in range(options.repeat):
                for name, path in [(EMPTY, empty), *((p.stem, p) for p in paths)]:
                    progress.update(bar, description=f"{name}, run {number + 1}")
                    taken = execute(path, options.stall)
                    if taken is None:
                        stalls[name] += 1
                    else:
                        runs[name].append(taken)
                    progress.advance(bar)
        except KeyboardInterrupt:
            print("stopped; what was measured until now:")
            report(runs, stalls, options.limit)
            return 130
    return 0 if report(runs, stalls, options.limit) else 1


if __name__ == "__main__":
    sys.exit(main())
