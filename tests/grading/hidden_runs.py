"""Grade one notebook with the real hidden tests, for tests of those tests."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat

from course_lib.grading.session import Job, grade_one

if TYPE_CHECKING:
    from collections.abc import Iterable

    from course_lib.grading.results import SubmissionResult, TestResult
    from course_lib.grading.sandbox import Launcher

ROOT = Path(__file__).parents[2]
TESTS = ROOT / "tests/hidden"


def edited(
    name: str, into: Path, edits: Iterable[tuple[str, str]], source: str = "solutions"
) -> Path:
    """Write a submission: a solution's notebook (and package) with parts of its code replaced."""
    into.mkdir(parents=True, exist_ok=True)
    notebook = nbformat.read(ROOT / source / name, as_version=4)
    for old, new in edits:
        hits = [c for c in notebook.cells if c.cell_type == "code" and old in c.source]
        assert len(hits) == 1, f"{old!r} is in {len(hits)} cells"
        assert hits[0].source.count(old) == 1, f"{old!r} is there more than once"
        hits[0].source = hits[0].source.replace(old, new)
    nbformat.write(notebook, into / name)
    if "4_2" in name:
        shutil.copytree(ROOT / source / "unit4", into / "unit4")
    return into


def graded(
    folder: Path, exercise: str, launcher: Launcher, seed: bytes = b"a seed of these tests"
) -> SubmissionResult:
    """Grade a submission's folder."""
    return grade_one(Job("student", (folder,), seed, (exercise,), TESTS), launcher)


def by_number(result: SubmissionResult) -> dict[str, TestResult]:
    """Return the tests by their place in the rubric."""
    return {test.number: test for test in result.tests}


def lost(result: SubmissionResult) -> set[str]:
    """Return the numbers of the tests that lost points."""
    return {test.number for test in result.tests if test.score < test.max_score}
