"""Gathers what the class page shows, reading the students' results one at a time."""

from __future__ import annotations

import statistics
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_lib.grading.similarity import Group, groups
from course_lib.grading.summary import (
    Checked,
    Summary,
    exercise_of,
    in_order,
    line,
    summaries,
)

if TYPE_CHECKING:
    from pathlib import Path

BINS = 10


@dataclass
class TestFigures:
    """How the class did in one test.

    Attributes
    ----------
    number, name : str
    shares : list of float
        The share of the points that each student reached whose submission could be checked.
    unchecked : int
        Submissions in which the test could not be run.
    """

    __test__ = False  # not a test class for pytest

    number: str
    name: str
    max_score: float
    shares: list[float] = field(default_factory=list)
    unchecked: int = 0

    @property
    def mean(self) -> float:
        """Mean share; 1 when nobody could be checked, so that the test is not called hard."""
        return statistics.fmean(self.shares) if self.shares else 1.0

    @property
    def full(self) -> int:
        """Students with all points."""
        return sum(share >= 1 for share in self.shares)

    @property
    def none(self) -> int:
        """Students without any."""
        return sum(share <= 0 for share in self.shares)


@dataclass(frozen=True)
class Row:
    """One student in the table."""

    name: str
    folder: str
    score: float
    max_score: float
    exercises: dict[str, float]
    status: Checked
    events: tuple[str, ...]

    @property
    def share(self) -> float:
        """Share of the points, from 0 to 1."""
        return self.score / self.max_score if self.max_score else 0.0


@dataclass
class ClassPage:
    """Everything that the class page shows.

    Attributes
    ----------
    rows : list of Row
    tests : list of TestFigures
        Hardest first.
    alike : list of (str, list of Row, float)
        Exercise, students with nearly the same code, and how near.
    damaged : list of str
        Folders whose results cannot be read.
    maxima : dict
        Exercise to its points.
    """

    rows: list[Row] = field(default_factory=list)
    tests: list[TestFigures] = field(default_factory=list)
    alike: list[tuple[str, list[Row], float]] = field(default_factory=list)
    damaged: list[str] = field(default_factory=list)
    maxima: dict[str, float] = field(default_factory=dict)

    @property
    def max_score(self) -> float:
        """Points that could be reached."""
        return max((row.max_score for row in self.rows), default=0.0)

    @property
    def mean(self) -> float:
        """Mean points."""
        return statistics.fmean(row.score for row in self.rows)

    @property
    def median(self) -> float:
        """Median points."""
        return statistics.median(row.score for row in self.rows)

    @property
    def full(self) -> int:
        """Students with all points."""
        return sum(row.share >= 1 for row in self.rows)

    @property
    def incomplete(self) -> list[Row]:
        """Students for whom some test could not be run."""
        return [row for row in self.rows if row.status != "graded"]

    @property
    def noticed(self) -> list[Row]:
        """Students with events."""
        return [row for row in self.rows if row.events]

    @property
    def in_groups(self) -> set[str]:
        """Folders of students with nearly the same code as another's."""
        return {row.folder for _, rows, _ in self.alike for row in rows}

    @property
    def suspicious(self) -> set[str]:
        """Folders of students that an instructor should look at."""
        noticed = {row.folder for row in [*self.noticed, *self.incomplete]}
        return noticed | self.in_groups

    @property
    def histogram(self) -> list[int]:
        """Students by tenth of the points; full marks belong to the last tenth."""
        counts = [0] * BINS
        for row in self.rows:
            counts[max(0, min(int(row.share * BINS + 1e-9), BINS - 1))] += 1
        return counts


def gather(out: Path) -> ClassPage:
    """Read the results of a class.

    Parameters
    ----------
    out : Path
        The folder with a folder for each student.
    """
    page = ClassPage()
    tests: dict[str, TestFigures] = {}
    code: defaultdict[str, dict[str, frozenset[int]]] = defaultdict(dict)
    for summary in summaries(out):
        if not isinstance(summary, Summary):
            page.damaged.append(line(summary.name, 120))
            continue
        page.rows.append(_row(summary))
        for exercise, most in _by_exercise(summary, "max_score").items():
            page.maxima[exercise] = max(page.maxima.get(exercise, 0.0), most)
        _count(summary, tests)
        for exercise, marks in summary.code.items():
            code[exercise][summary.folder] = marks
    page.maxima = dict(sorted(page.maxima.items(), key=lambda item: in_order(item[0])))
    page.tests = sorted(tests.values(), key=lambda test: (test.mean, in_order(test.number)))
    by_folder = {row.folder: row for row in page.rows}
    found: list[tuple[str, Group]] = [
        (exercise, group) for exercise in sorted(code) for group in groups(code[exercise])
    ]
    page.alike = [
        (exercise, [by_folder[name] for name in group.students], group.alike)
        for exercise, group in sorted(found, key=lambda pair: -pair[1].alike)
    ]
    return page


def _row(summary: Summary) -> Row:
    return Row(
        name=line(summary.student, 120) or "no name",
        folder=summary.folder,
        score=summary.score,
        max_score=summary.max_score,
        exercises=_by_exercise(summary, "score"),
        status=summary.status,
        events=tuple(line(event, 500) for event in summary.events),
    )


def _by_exercise(summary: Summary, what: str) -> dict[str, float]:
    sums: defaultdict[str, float] = defaultdict(float)
    for test in summary.tests:
        sums[exercise_of(test.number)] += getattr(test, what)
    return dict(sums)


def _count(summary: Summary, tests: dict[str, TestFigures]) -> None:
    for test in summary.tests:
        key = test.number or test.name
        figures = tests.setdefault(key, TestFigures(test.number, test.name, test.max_score))
        if test.status == "not_checked":
            figures.unchecked += 1
        elif test.max_score > 0:
            figures.shares.append(test.score / test.max_score)
