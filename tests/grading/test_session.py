"""Grading one submission, where no sandbox can be had."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from course_lib.grading.sandbox import Limits, SandboxError
from course_lib.grading.session import Job, grade_one

ROOT = Path(__file__).resolve().parents[2]


class NoLauncher:
    """Starts nothing."""

    limits = Limits()

    def kernel(self, _folder: Path) -> None:
        raise SandboxError("no processes left")


def test_a_sandbox_that_fails_is_no_result(tmp_path):
    """The student would keep zero points, which no later run would look at again."""
    shutil.copy(ROOT / "solutions" / "exercise_4_1.ipynb", tmp_path)
    job = Job("ann", (tmp_path,), b"a secret", ("4.1",), ROOT / "tests/grading/quick_hidden")
    with pytest.raises(SandboxError, match="no processes left"):
        grade_one(job, NoLauncher())
