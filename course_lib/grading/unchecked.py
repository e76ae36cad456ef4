"""The result of a submission that could not be graded: every test is there, none was checked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_lib.grading.results import SubmissionResult, TestResult

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    import pytest

    from course_lib.grading.messages import Settings, Task

_TOLD = "This could not be checked; your instructor has been told."


def unchecked(task: Task, settings: Settings, reason: str) -> SubmissionResult:
    """Make the result of a submission that could not be graded.

    Parameters
    ----------
    task : Task
    settings : Settings
    reason : str
        For the instructor.

    Returns
    -------
    SubmissionResult
        With all tests of the exercises, if these can be read.
    """
    tests = tuple(
        TestResult(title, number, 0.0, worth, _TOLD, "not_checked")
        for worth, number, title in rubric_of(settings.tests, settings.exercises)
    )
    return SubmissionResult(
        task.student, tests, events=(f"could not be checked: {reason}",), fingerprint=""
    )


def rubric_of(tests: Path, exercises: tuple[str, ...]) -> list[tuple[float, str, str]]:
    """List what the hidden tests give: points, number and title of each.

    Imports them, under pytest.

    Parameters
    ----------
    tests : Path
        Their folder.
    exercises : tuple of str

    Returns
    -------
    list of tuple
        Sorted by number.
    """
    from course_lib.grading import pytest_run  # noqa: PLC0415

    paths = [
        path
        for exercise in exercises
        for path in sorted(tests.glob(f"test_{exercise.replace('.', '_')}*.py"))
    ]
    if not paths:
        return []
    rubric = _Rubric()
    pytest_run.run(paths, tests, [rubric], ["--collect-only"])
    return sorted(rubric.found, key=lambda test: test[1])


class _Rubric:
    def __init__(self) -> None:
        self.found: list[tuple[float, str, str]] = []

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        self.found += _marks(session)


def _marks(session: pytest.Session) -> Iterator[tuple[float, str, str]]:
    for item in session.items:
        mark = item.get_closest_marker("points")
        if mark is not None:
            worth, number, title = mark.args
            yield float(worth), str(number), str(title)
