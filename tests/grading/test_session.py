"""Grading one submission, where no kernel can be had."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from course_lib.grading.sandbox import LimitError, Limits, SandboxError
from course_lib.grading.session import Job, grade_one

ROOT = Path(__file__).resolve().parents[2]


class NoLauncher:
    """Starts nothing."""

    limits = Limits()

    def __init__(self, error: Exception) -> None:
        self._error = error

    def kernel(self, _folder: Path) -> None:
        raise self._error


def job_in(folder: Path) -> Job:
    shutil.copy(ROOT / "solutions" / "exercise_4_1.ipynb", folder)
    return Job(
        "ann", (folder,), b"a secret of the tests", ("4.1",), ROOT / "tests/grading/quick_hidden"
    )


def test_a_sandbox_that_fails_is_no_result(tmp_path):
    """The student would keep zero points, which no later run would look at again."""
    with pytest.raises(SandboxError, match="no processes left"):
        grade_one(job_in(tmp_path), NoLauncher(SandboxError("no processes left")))


def test_a_limit_that_is_exceeded_before_the_first_cell_is_one(tmp_path):
    """What was handed in may be so much that it is ended before its kernel answers."""
    result = grade_one(job_in(tmp_path), NoLauncher(LimitError("disk limit of 256 MiB")))
    assert result.score == 0
    assert "disk limit of 256 MiB" in result.tests[0].output
    assert all(test.status != "not_checked" for test in result.tests), result.events
