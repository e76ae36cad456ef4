"""Runs pytest as the grader needs it: given files, no plugins but what grading uses, no output."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

# What pytest brings and grading has no use for; the last two collect garbage again and again.
_OFF = (
    "cacheprovider",
    "doctest",
    "faulthandler",
    "junitxml",
    "logging",
    "pastebin",
    "recwarn",
    "setuponly",
    "setupplan",
    "stepwise",
    "unittest",
    "threadexception",
    "unraisableexception",
)


def run(
    paths: Sequence[Path], root: Path, plugins: Sequence[object], options: Sequence[str] = ()
) -> int | pytest.ExitCode:
    """Collect and run some files.

    Parameters
    ----------
    paths : sequence of Path
        Test files and notebooks; none for nothing.
    root : Path
        The folder that test ids are relative to.
    plugins : sequence of object
        Their hooks make of it what they like. By name, pytest would look for one among all
        packages that are installed, each time.
    options : sequence of str, optional
        More options.

    Returns
    -------
    pytest.ExitCode
    """
    given = ["-q", "-s", "--tb=no", "--color=no", "--noconftest", "-c", os.devnull]
    given += [f"--rootdir={root}", *options]
    for name in _OFF:
        given += ["-p", f"no:{name}"]
    arguments = [*given, *map(str, paths)]
    with (
        _no_other_plugins(),
        Path(os.devnull).open("w") as nowhere,
        contextlib.redirect_stdout(nowhere),
    ):
        return pytest.main(arguments, plugins=[*plugins, _Straight(paths)])


@contextlib.contextmanager
def _no_other_plugins() -> Iterator[None]:
    """Leave out what happens to be installed: it costs start-up time and has no say here.

    Pytest takes this from the environment only, where the caller wants nothing left.
    """
    name = "PYTEST_DISABLE_PLUGIN_AUTOLOAD"
    before = os.environ.get(name)
    os.environ[name] = "1"
    try:
        yield
    finally:
        os.environ.pop(name)
        if before is not None:
            os.environ[name] = before


class _Straight:
    """Goes to the given files directly; pytest would look at all that lies beside their parents."""

    def __init__(self, paths: Sequence[Path]) -> None:
        self._paths = paths

    def pytest_configure(self, config: pytest.Config) -> None:
        """Make the rubric's mark known."""
        config.addinivalue_line("markers", "points(value, number, title): what a test is worth")

    def pytest_collect_directory(self, path: Path, parent: pytest.Collector) -> pytest.Collector:
        """Collect no more of a folder than what leads to a given file."""
        folder: Any = _Folder.from_parent(parent, path=path)
        folder.given = [given for given in self._paths if given.is_relative_to(path)]
        return folder  # type: ignore[no-any-return]


class _Folder(pytest.Directory):
    given: list[Path]

    def collect(self) -> Iterator[pytest.Collector]:
        within = {self.path / given.relative_to(self.path).parts[0] for given in self.given}
        for path in sorted(within):
            if path in self.given:
                yield from self.ihook.pytest_collect_file(file_path=path, parent=self)
            else:
                yield self.ihook.pytest_collect_directory(path=path, parent=self)
