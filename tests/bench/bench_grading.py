"""
Seconds per submission: `course grade` against nbgrader, otter-grader and no grader at all.

All grade the same notebook with the same four public checks and four hidden tests (`graders/`), on
two processors, in interleaved rounds of one run; the medians over the rounds are compared, so the
ratios hold on any machine. Processor time is compared with that of the plain script; two scripts at
a time, which leave OpenCV fewer idle threads, are shown beside it. Everything counts, from the
start of a command to its end, and every process that it starts. Before, each must give a right
submission 8 points and a wrong one 3.
Then `course grade` grades classes of several sizes: its memory must not grow with them.

The other graders are installed, each in an environment of its own, when they are first wanted.

    python tests/bench/bench_grading.py [--rounds N] [--submissions N] [--memory N …] [--alone]
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

from graders import peers
from graders.assignment import FULL_SCORE, WRONG_SCORE, cells
from graders.contestants import Contestant, Nbgrader, Otter, Ours, Script
from graders.memory import ROLES, Peaks
from graders.usage import CommandError, Spent
from rich.console import Console
from rich.table import Table

BAR_THROUGHPUT = 4.0  # times nbgrader's
BAR_CPU = 1.3  # times the plain script's
BAR_MEMORY = 1.05  # times the smallest class's


@dataclass(frozen=True)
class Bar:
    """Something promised, and what was measured; None where it could not be."""

    text: str
    reached: bool | None


def say(text: str) -> None:
    print(f"  {text}", file=sys.stderr, flush=True)


def names(count: int) -> list[str]:
    return [f"student-{number:03}" for number in range(1, count + 1)]


def prepare(contestant: Contestant, students: list[str]) -> None:
    """Submit everything, once it tells right from wrong; that also fills the system's caches."""
    say(f"{contestant.title}: does it tell right from wrong?")
    first, *others = students
    contestant.submit(first, cells(first))
    contestant.submit("wrong", cells("wrong", wrong=True))
    contestant.run([first, "wrong"])
    scores = contestant.scores()
    if scores != {first: FULL_SCORE, "wrong": WRONG_SCORE}:
        raise CommandError(f"{contestant.title} gave {scores}")
    contestant.withdraw("wrong")
    for student in others:
        contestant.submit(student, cells(student))


def measure(
    contestants: list[Contestant], students: list[str], rounds: int
) -> dict[str, list[Spent]]:
    """Grade everything in turn; give what each took for a submission, a figure for each round."""
    spent: dict[str, list[Spent]] = defaultdict(list)
    for number in range(1, rounds + 1):
        for contestant in contestants:
            some = students[: contestant.most]
            taken = contestant.run(some).per(len(some))
            say(f"round {number}: {contestant.title}: {taken.wall:.2f} s")
            scores = contestant.scores()
            if any(scores.get(student) != FULL_SCORE for student in some):
                raise CommandError(f"{contestant.title} gave {scores}")
            spent[contestant.title].append(taken)
    return spent


def middle(spent: list[Spent]) -> Spent:
    cpus = [each.cpu for each in spent if each.cpu is not None]
    wall = statistics.median(each.wall for each in spent)
    return Spent(wall, statistics.median(cpus) if cpus else None)


def report_speed(
    contestants: list[Contestant], spent: dict[str, list[Spent]], students: list[str]
) -> list[Bar]:
    """Print the table; give the bars on speed."""
    medians = {title: middle(some) for title, some in spent.items()}
    batch = medians.get(Nbgrader.title)
    table = Table("per submission, medians", "graded", "wall s", "CPU s", "CPU ÷ script", "")
    bars = []
    for contestant in contestants:
        own = medians[contestant.title]
        script = medians[Script.titled(1)]
        cpu = own.cpu / script.cpu if own.cpu and script.cpu else None
        times = batch.wall / own.wall if batch else None
        table.add_row(
            contestant.title,
            f"{len(spent[contestant.title])} × {len(students[: contestant.most])}",
            f"{own.wall:.2f}",
            "–" if own.cpu is None else f"{own.cpu:.2f}",
            "–" if cpu is None else f"{cpu:.2f}",
            "" if times is None else f"{times:.1f} × nbgrader's throughput",
        )
        if isinstance(contestant, Ours):
            some = f"{contestant.workers} worker{'s' if contestant.workers > 1 else ''}"
            if times and contestant.workers == 2:
                text = f"{times:.1f} times nbgrader's throughput (bar: {BAR_THROUGHPUT:g})"
                bars.append(Bar(f"{some}: {text}", times >= BAR_THROUGHPUT))
            text = f"CPU {'?' if cpu is None else f'{cpu:.2f}'} times the script's"
            bars.append(
                Bar(f"{some}: {text} (bar: {BAR_CPU})", None if cpu is None else cpu <= BAR_CPU)
            )
    Console(width=110).print(table)
    if any(median.cpu is None for median in medians.values()):
        print("no control group can be made here, so nobody can say what the sandboxes' CPU was")
    return bars


def report_memory(grader: Ours, sizes: list[int]) -> list[Bar]:
    """Grade classes of several sizes; print the peaks, and give the bar on memory."""
    rows = []
    table = Table("submissions", *(f"{role}, MiB" for role in ROLES), "wall s each")
    for size in sizes:
        grader.watch = Peaks()
        taken = grader.run(names(size)).per(size)
        say(f"{size} submissions: {taken.wall:.2f} s each")
        if list(grader.scores().values()) != [FULL_SCORE] * size:
            raise CommandError(f"not all of {size} submissions got all points")
        rows.append(grader.watch.mib)
        figures = [f"{grader.watch.mib[role]:.0f}" for role in ROLES]
        table.add_row(str(size), *figures, f"{taken.wall:.2f}")
    grader.watch = None
    Console(width=110).print(table)
    growth = max(max(row[role] for row in rows) / rows[0][role] for role in ROLES)
    text = f"from {sizes[0]} to {sizes[-1]} submissions, peak memory × {growth:.3f}"
    return [Bar(f"{text} (bar: {BAR_MEMORY})", growth <= BAR_MEMORY)]


def load() -> str:
    return " ".join(f"{average:.1f}" for average in os.getloadavg())


def compete(options: argparse.Namespace, folder: Path) -> list[Bar]:
    students = names(options.submissions)
    contestants: list[Contestant] = [Script(folder / f"script-{n}", n) for n in (2, 1)]
    contestants += [Ours(folder / f"ours-{workers}", workers) for workers in (2, 1)]
    if not options.alone:
        for peer in (peers.NBGRADER, peers.OTTER):
            peer.install()
        contestants += [Nbgrader(folder / "nbgrader"), Otter(folder / "otter")]
    for contestant in contestants:
        prepare(contestant, students)
    bars = report_speed(contestants, measure(contestants, students, options.rounds), students)
    sizes = sorted(set(options.memory))
    if sizes:
        grader = Ours(folder / "class", 2)
        for student in names(sizes[-1]):
            grader.submit(student, cells(student))
        bars += report_memory(grader, sizes)
    return bars


def main() -> int:
    """Measure; exit status 1 when a bar was missed or a grader failed."""
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    add = parser.add_argument
    add("--rounds", type=int, default=3, metavar="N", help="interleaved rounds (3)")
    add("--submissions", type=int, default=20, metavar="N", help="in a round (20)")
    add("--memory", type=int, nargs="*", default=[10, 50, 200], metavar="N", help="class sizes")
    add("--alone", action="store_true", help="without nbgrader and otter-grader")
    options = parser.parse_args()
    if min(options.rounds, options.submissions, *options.memory) < 1:
        parser.error("numbers must be at least 1")
    print(f"load before: {load()} on {os.cpu_count()} processors")
    try:
        with tempfile.TemporaryDirectory(prefix="bench-grading-") as folder:
            bars = compete(options, Path(folder))
    except CommandError as error:
        print(f"stopped: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    print(f"load after: {load()}; where others work, trust the ratios of CPU alone")
    for bar in bars:
        print(
            f"{ {True: 'reached', False: 'MISSED', None: 'not measured'}[bar.reached] }: {bar.text}"
        )
    return 0 if all(bar.reached is not False for bar in bars) else 1


if __name__ == "__main__":
    sys.exit(main())
