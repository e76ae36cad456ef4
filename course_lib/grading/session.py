"""
Grades one submission: nbval executes its notebooks, hidden tests question its functions.

Both run here, in the grader's process, under pytest. The student's code runs in sandboxed kernels.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import nbformat
import nbval.plugin
import pytest

from course_lib.grading import pytest_run
from course_lib.grading.plugin import Grading
from course_lib.grading.results import SubmissionResult
from course_lib.grading.scratch import working_folder
from course_lib.grading.similarity import of_submission
from course_lib.grading.submission import Source, stage
from course_lib.grading.unchecked import rubric_of

if TYPE_CHECKING:
    from pathlib import Path

    from course_lib.grading.sandbox import Launcher

_MOST_EVENTS = 60


@dataclass(frozen=True)
class Job:
    """One submission to grade.

    Attributes
    ----------
    student : str
        Its name, safe as a folder's name.
    paths : tuple of Path
        Its folder, archive or notebooks.
    seed : bytes
        The instructor's secret.
    exercises : tuple of str
        Such as ``("4.1", "4.2")``.
    tests : Path
        The folder of hidden tests; `test_4_1*.py` are those of Exercise 4.1.
    fingerprint : str
        Goes into the result as it is.
    ros : bool
        Whether its nodes run on real ROS instead of `offline_ros`.
    """

    student: str
    paths: tuple[Path, ...]
    seed: bytes = field(repr=False)
    exercises: tuple[str, ...]
    tests: Path
    fingerprint: str = ""
    ros: bool = False


def grade_one(job: Job, launcher: Launcher) -> SubmissionResult:
    """Grade one submission; whatever it holds, there is a result.

    Parameters
    ----------
    job : Job
        What to grade.
    launcher : Launcher
        Starts sandboxed kernels.

    Returns
    -------
    SubmissionResult

    Raises
    ------
    SandboxError
        When there is no sandbox to grade it in: that is no result, and may be tried again.
    """
    started = time.monotonic()
    with working_folder() as scratch:
        submission = stage(Source(job.student, job.paths), scratch / "staged")
        plugin = Grading(job, launcher, submission, scratch, started)
        try:
            _run_pytest(job, plugin)
        finally:
            plugin.close()
        if plugin.broken:
            raise plugin.broken
        plugin.events += submission.events
        return SubmissionResult(
            student=job.student,
            tests=tuple(sorted(plugin.results, key=lambda result: result.number)),
            notes=submission.notes,
            events=_some(plugin.events),
            pictures=tuple(plugin.pictures),
            scenes=tuple(plugin.scenes),
            code=of_submission(submission.notebooks, submission.folder / "unit4"),
            fingerprint=job.fingerprint,
            seconds=time.monotonic() - started,
        )


def _some(events: list[str]) -> tuple[str, ...]:
    """Give each event once, and so many that an instructor still sees the other students'."""
    kept = list(dict.fromkeys(events))
    more = len(kept) - _MOST_EVENTS
    return tuple(kept[:_MOST_EVENTS] + ([f"and {more} more"] if more > 0 else []))


def warm_up(tests: Path, exercises: tuple[str, ...]) -> None:
    """Do once what each grading would do anew; those that are forked from here find it done.

    Parameters
    ----------
    tests : Path
        As in `Job`; they are imported.
    exercises : tuple of str
    """
    nbformat.validate(nbformat.v4.new_notebook())  # type: ignore[no-untyped-call]
    rubric_of(tests, exercises)


def _run_pytest(job: Job, plugin: Grading) -> None:
    paths: list[Path] = []
    for exercise in job.exercises:
        if exercise in plugin.submission.notebooks:
            paths.append(plugin.notebook_for_nbval(exercise))
        paths += sorted(job.tests.glob(f"test_{exercise.replace('.', '_')}*.py"))
    options = [f"--nbval-cell-timeout={plugin.limits.cell_s}"]
    status = pytest_run.run(paths, job.tests, [nbval.plugin, plugin], options)
    if status not in {pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED}:
        plugin.events.append(f"the grader's own test run ended with {status!r}")
    plugin.add_missing()
