"""
Seconds to execute each notebook, against starting and ending a kernel with nothing to do.

Both are measured in the same run, so the ratio holds on any machine. With --repeat, every notebook
is executed that many times in a row; a run that takes longer than --limit is reported as a stall.

    python tests/bench/bench_notebooks.py [--repeat N] [--limit S] [NOTEBOOK …]
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
import time
from collections import defaultdict
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


def execute(path: Path, limit: float) -> float | None:
    """Seconds of one execution, or None when a cell stalled beyond the limit."""
    start = time.perf_counter()
    try:
        run_notebook(path, cell_timeout=limit)
    except NotebookFailed as error:
        if "took longer than" not in str(error):
            raise  # a notebook that is wrong has no speed
        return None
    return time.perf_counter() - start


def report(seconds: dict[str, list[float]], stalls: dict[str, int], limit: float) -> bool:
    """Print the table; return whether every run ended within the limit."""
    if not seconds[EMPTY]:
        print("nothing was measured")
        return False
    floor = statistics.median(seconds[EMPTY])
    table = Table("notebook", "runs", "median s", "max s", "× empty kernel", "stalls")
    for name, runs in seconds.items():
        if runs:
            middle = statistics.median(runs)
            figures = (f"{middle:.2f}", f"{max(runs):.2f}", f"{middle / floor:.1f}")
        else:
            figures = ("–", "–", "–")
        table.add_row(name, str(len(runs) + stalls[name]), *figures, str(stalls[name]))
    total = sum(statistics.median(runs) for name, runs in seconds.items() if runs and name != EMPTY)
    Console().print(table)
    slowest = max((max(runs) for runs in seconds.values() if runs), default=0)
    print(f"all notebooks once: {total:.1f} s, {total / floor:.1f} × one empty kernel")
    print(f"slowest run: {slowest:.2f} s (bar: {limit:g} s); stalls: {sum(stalls.values())}")
    return slowest <= limit and not any(stalls.values())


def main() -> int:
    """Measure; exit status 1 when a run stalled or missed the bar."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument("notebooks", nargs="*", type=Path, help="default: the course's")
    parser.add_argument("--repeat", type=int, default=1, metavar="N", help="runs of each (1)")
    parser.add_argument("--limit", type=float, default=20.0, metavar="S", help="bar in s (20)")
    options = parser.parse_args()
    if options.repeat < 1:
        parser.error("--repeat must be at least 1")
    try:
        paths = find_notebooks(options.notebooks or [FOLDER])
    except FileNotFoundError as error:
        parser.error(str(error))

    seconds: dict[str, list[float]] = {EMPTY: []} | {path.stem: [] for path in paths}
    stalls: dict[str, int] = defaultdict(int)
    with (
        tempfile.TemporaryDirectory() as folder,
        Progress(console=Console(stderr=True), transient=True) as progress,
    ):
        empty = Path(folder) / "empty.ipynb"
        nbformat.write(new_notebook(cells=[new_code_cell("")]), empty)
        execute(empty, options.limit)  # the first start reads files from the disk
        bar = progress.add_task("", total=options.repeat * (len(paths) + 1))
        try:
            for number in range(options.repeat):
                for name, path in [(EMPTY, empty), *((p.stem, p) for p in paths)]:
                    progress.update(bar, description=f"{name}, run {number + 1}")
                    taken = execute(path, options.limit)
                    if taken is None:
                        stalls[name] += 1
                    else:
                        seconds[name].append(taken)
                    progress.advance(bar)
        except KeyboardInterrupt:
            print("stopped; what was measured until now:")
    return 0 if report(seconds, stalls, options.limit) else 1


if __name__ == "__main__":
    sys.exit(main())
