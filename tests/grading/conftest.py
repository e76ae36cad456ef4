"""Real sandboxes for the grader's tests: one warm launcher of each kind."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_lib.grading.sandbox import Launcher, Limits

TIGHT = Limits(
    wall_s=90,
    cell_s=20,
    call_s=5,
    cpu_s=8,
    memory_bytes=700 * 2**20,
    processes=24,
    file_bytes=16 * 2**20,
    disk_bytes=32 * 2**20,
    output_bytes=8 * 2**20,
)


@pytest.fixture(scope="session", params=["bubblewrap", "sandlock"])
def launcher(request: pytest.FixtureRequest) -> Iterator[Launcher]:
    with Launcher(request.param, TIGHT) as launcher:
        yield launcher


@pytest.fixture
def folder() -> Iterator[Path]:
    """A working folder below one that others may pass through, as a session makes it."""
    parent = Path(tempfile.mkdtemp(prefix="test-"))
    parent.chmod(0o711)
    (parent / "work").mkdir()
    yield parent / "work"
    shutil.rmtree(parent)
