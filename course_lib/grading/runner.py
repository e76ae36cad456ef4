"""Grades a class: what is new or changed, in parallel, resumable, with one writer."""

from __future__ import annotations

import fcntl
import os
import time
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from course_lib.grading import report, similarity
from course_lib.grading.fingerprint import Fingerprints
from course_lib.grading.messages import Finished, Settings, Started, Task
from course_lib.grading.results import SubmissionResult
from course_lib.grading.sandbox.places import seen_by_students
from course_lib.grading.submission import find_submissions, passed_over
from course_lib.grading.summary import INSTRUCTOR, graded

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from course_lib.grading.progress import Progress
    from course_lib.grading.submission import Source

_RESULTS_PER_PAGE = 20
_PAGE_SHARE = 0.1  # of the time, at most, for class pages of an unfinished run
LOCK = ".lock"
GONE = "no_longer_submitted.txt"


class UsageError(ValueError):
    """What was asked for cannot be done; the message says why and what to do."""


class Backend(Protocol):
    """Where grading is done: on this machine, or on a cluster."""

    def run(self, tasks: Iterable[Task]) -> Iterator[Started | Finished]:
        """Grade; leaving the iteration ends everything that was started."""


@dataclass(frozen=True)
class Options:
    """What to grade, and where to.

    Attributes
    ----------
    submissions, out : Path
    settings : Settings
        How each is graded.
    only : tuple of str
        Students; empty for all.
    fresh : bool
        Whether unchanged submissions are graded again.
    """

    submissions: Path
    out: Path
    settings: Settings
    only: tuple[str, ...] = ()
    fresh: bool = False


@dataclass
class Outcome:
    """What a run came to.

    Attributes
    ----------
    graded, unchanged : list of str
        Students.
    failures : dict of str to str
        Students whom the grader itself could not grade, and why. They have a result that says so,
        and are graded anew by the next run.
    gone : list of str
        Folders of results whose students are no longer among the submissions; kept.
    passed_over : list of str
        What lies among the submissions and was taken for none.
    """

    graded: list[str] = field(default_factory=list)
    unchanged: list[str] = field(default_factory=list)
    failures: dict[str, str] = field(default_factory=dict)
    gone: list[str] = field(default_factory=list)
    passed_over: list[str] = field(default_factory=list)

    @property
    def status(self) -> int:
        """The exit status: 0 when everybody was graded, whatever the points."""
        return 1 if self.failures else 0


def grade_class(options: Options, backend: Backend, progress: Progress) -> Outcome:
    """Grade every submission that is new or changed.

    Each result is written as it comes, so an interrupted run has lost nothing; the same call goes
    on where it was.

    Parameters
    ----------
    options : Options
    backend : Backend
    progress : Progress
        Is told what happens.

    Returns
    -------
    Outcome

    Raises
    ------
    UsageError
        When there is nothing to grade, or the folders make no sense together.
    """
    sources = _sources(options)
    with _locked(options.out):
        outcome = Outcome(
            gone=_gone(options.out, sources), passed_over=passed_over(options.submissions)
        )
        tasks = _tasks(options, sources, outcome)
        progress.start(len(tasks), outcome)
        page = _ClassPage(options.out)
        try:
            if tasks:
                # Workers take a second to start; later these would hold up results.
                report.prepare()
                similarity.published()
                _grade(options, tasks, backend, progress, outcome, page)
        finally:
            progress.stop()
            page.write()
    return outcome


def _grade(
    options: Options,
    tasks: list[Task],
    backend: Backend,
    progress: Progress,
    outcome: Outcome,
    page: _ClassPage,
) -> None:
    events = backend.run(tasks)
    try:
        for event in events:
            if isinstance(event, Started):
                progress.started(event.student)
                continue
            done = _write(options.out, event)
            outcome.graded.append(done.result.student)
            if done.failure:
                outcome.failures[done.result.student] = done.failure
            progress.finished(done)
            page.count()
    finally:
        close = getattr(events, "close", None)
        if close:
            close()  # now, not when the garbage is collected: it ends the sandboxes


def _write(out: Path, event: Finished) -> Finished:
    """Write a result; what cannot be shown must not stop the class."""
    result = event.result
    folder = report.student_folder(out, result.student)
    try:
        code = similarity.own(result.code)
        report.write_student(result, folder, code_fingerprint=code)
    except OSError:  # the disk is full: nobody's result can be written
        raise
    except Exception as error:  # noqa: BLE001
        reason = f"the report could not be written: {type(error).__name__}: {error}"
        tests = tuple(replace(test, output="") for test in result.tests)
        bare = SubmissionResult(result.student, tests, events=(reason,), seconds=result.seconds)
        report.write_student(bare, folder)
        return Finished(bare, event.failure or reason)
    return event


class _ClassPage:
    """Writes the class page now and then, and never spends more than a part of the time on it."""

    def __init__(self, out: Path) -> None:
        self._out = out
        self._new = 0
        self._took = 0.0
        self._next = 0.0

    def count(self) -> None:
        self._new += 1
        if self._new >= _RESULTS_PER_PAGE and time.monotonic() > self._next:
            self.write()

    def write(self) -> None:
        start = time.monotonic()
        report.write_class(self._out)
        self._new = 0
        self._took = time.monotonic() - start
        self._next = time.monotonic() + self._took / _PAGE_SHARE


def _sources(options: Options) -> list[Source]:
    out, root = options.out.resolve(), options.submissions.resolve()
    if out == root or out.is_relative_to(root):
        raise UsageError(
            f"--out {options.out} lies in {options.submissions}: it would be taken for a "
            "submission. Give a folder outside"
        )
    if root.is_relative_to(out):
        raise UsageError(f"{options.submissions} lies in --out {options.out}; give another folder")
    for path in (root, out, options.settings.tests):
        place = seen_by_students(path) if options.settings.sandbox != "none" else None
        if place:
            raise UsageError(f"{path} lies in {place}, which students' code can read; move it")
    if not any(
        any(options.settings.tests.glob(f"test_{exercise.replace('.', '_')}*.py"))
        for exercise in options.settings.exercises
    ):
        raise UsageError(
            f"there are no hidden tests test_4_1*.py in {options.settings.tests}; name their "
            "folder with --tests"
        )
    try:
        sources = find_submissions(options.submissions)
    except OSError as error:
        raise UsageError(str(error)) from error
    if not sources:
        raise UsageError(
            f"no submissions in {options.submissions}: it should hold a folder or a zip for each "
            "student"
        )
    unknown = set(options.only) - {source.student for source in sources}
    if unknown:
        raise UsageError(f"no submission of {', '.join(sorted(unknown))}")
    return sources


def _tasks(options: Options, sources: list[Source], outcome: Outcome) -> list[Task]:
    fingerprints = Fingerprints(options.settings)
    tasks = []
    for source in sources:
        if options.only and source.student not in options.only:
            continue
        fingerprint = fingerprints(source.paths)
        paths = tuple(Path(os.path.abspath(path)) for path in source.paths)  # noqa: PTH100  (not through links)
        if not options.fresh and _known(options.out, source.student) == fingerprint:
            outcome.unchanged.append(source.student)
        else:
            tasks.append(Task(source.student, paths, fingerprint))
    return tasks


def _known(out: Path, student: str) -> str | None:
    """Give the fingerprint of the result that is there."""
    try:
        return report.read_summary(report.student_folder(out, student)).fingerprint
    except (OSError, ValueError):
        return None


def _gone(out: Path, sources: list[Source]) -> list[str]:
    """List the results whose students have no submission now, and leave the list with them."""
    here = {report.student_folder(out, source.student).name for source in sources}
    gone = [found.folder for found in graded(out) if found.folder not in here]
    listed = out / INSTRUCTOR / GONE
    if gone:
        listed.parent.mkdir(exist_ok=True)
        listed.write_text("".join(f"{name}\n" for name in gone), "utf-8", errors="replace")
    else:
        listed.unlink(missing_ok=True)
    return gone


@contextmanager
def _locked(out: Path) -> Iterator[None]:
    """Keep other runs out of a folder, which is made if need be."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(out / LOCK, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
    except OSError as error:
        raise UsageError(f"cannot write to {out}: {error.strerror}") from error
    with os.fdopen(descriptor, "r+b") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            other = file.read(20).decode(errors="replace").strip() or "?"
            raise UsageError(
                f"another run (process {other}) is writing to {out}; wait for it or give another "
                "--out"
            ) from None
        file.truncate(0)
        file.write(f"{os.getpid()}\n".encode())
        file.flush()
        yield
