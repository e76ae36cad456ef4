"""
The pytest plugin that grades: notebooks in sandboxes, fixtures for hidden tests, and their results.

nbval collects and executes the notebooks' cells, but in a kernel that this plugin brings.
"""

from __future__ import annotations

import shutil
from collections import defaultdict
from typing import TYPE_CHECKING, Any

import cv2
import pytest
from nbval.plugin import IPyNbCell, IPyNbFile, NbCellError

from course_lib.grading.channel import KernelGoneError
from course_lib.grading.error_hints import hint
from course_lib.grading.nbval_kernel import NbvalKernel
from course_lib.grading.notebook import Notebook
from course_lib.grading.replies import NotSubmittedError, StudentError
from course_lib.grading.results import Picture, TestResult
from course_lib.grading.rubric import Grade, GradeFailed
from course_lib.grading.sandbox import SandboxError
from course_lib.grading.seeds import Seeds
from course_lib.grading.student import Student
from course_lib.grading.text import clean

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from course_lib.grading.results import Status
    from course_lib.grading.sandbox import Launcher
    from course_lib.grading.session import Job
    from course_lib.grading.submission import Submission

_SHOWN_PICTURES = 12
_WIDEST = 800  # px
_TOO_LONG = "took too long and was stopped"


class Grading:
    """Grades one submission while pytest runs.

    Parameters
    ----------
    job : Job
    launcher : Launcher
        Starts sandboxed kernels.
    submission : Submission
        Staged.
    scratch : Path
        A folder for what is made meanwhile.
    started : float
        When grading began, by the monotonic clock.

    Attributes
    ----------
    results : list of TestResult
    pictures, scenes : list of Picture
        What the notebooks drew, and what the hidden tests showed.
    events : list of str
        For the instructor.
    broken : SandboxError or None
        Why there is no result.
    """

    def __init__(
        self, job: Job, launcher: Launcher, submission: Submission, scratch: Path, started: float
    ) -> None:
        self.job = job
        self.submission = submission
        self.limits = launcher.limits
        self.results: list[TestResult] = []
        self.pictures: list[Picture] = []
        self.scenes: list[Picture] = []
        self.events: list[str] = []
        self.broken: SandboxError | None = None
        self._launcher = launcher
        self._scratch = scratch
        self._deadline = started + self.limits.wall_s
        self._notebooks: dict[str, Notebook] = {}
        self._grades: dict[str, Grade] = {}
        self._students: dict[str, Student] = {}
        self._collected: list[pytest.Item] = []

    def notebook_for_nbval(self, exercise: str) -> Path:
        """Copy a notebook for nbval, away from the submission's other files."""
        path = self._scratch / "nbval" / f"exercise_{exercise.replace('.', '_')}.ipynb"
        path.parent.mkdir(exist_ok=True)
        shutil.copyfile(self.submission.notebooks[exercise], path)
        return path

    def open_notebook(self, exercise: str) -> Notebook:
        """Give the notebook's execution, begun on first use in a folder of its own."""
        if exercise not in self._notebooks:
            self.close()  # one exercise at a time holds a kernel
            folder = self._scratch / f"work_{exercise.replace('.', '_')}"
            self._notebooks[exercise] = Notebook(
                self._launcher, self.submission.folder, folder, self.limits, self._deadline
            )
        return self._notebooks[exercise]

    def close(self) -> None:
        """End all kernels; keep what they drew and which limits they hit."""
        for notebook in self._notebooks.values():
            notebook.close()
            self.events += notebook.events
            notebook.events = []

    def pytest_collect_file(self, file_path: Path, parent: pytest.Collector) -> object:
        """Collect notebooks; nbval's own switch stays off, as its kernels are not sandboxed."""
        if file_path.suffix != ".ipynb":
            return None
        file = _SandboxedFile.from_parent(parent, path=file_path)
        file.grading, file.exercise = (
            self,
            file_path.stem.removeprefix("exercise_").replace("_", "."),
        )
        return file

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        """Remember which tests there are."""
        self._collected = [item for item in session.items if not isinstance(item, IPyNbCell)]

    def add_missing(self) -> None:
        """Give every test that was not reached a result that says so."""
        there = {result.number for result in self.results}
        for item in self._collected:
            worth, number, title = _points(item)
            if number not in there:
                told = "This could not be checked; your instructor has been told."
                self.results.append(TestResult(title, number, 0.0, worth, told, "not_checked"))

    @pytest.fixture
    def grade(self, request: pytest.FixtureRequest) -> Grade:
        """Collect credit and messages."""
        return self._grades.setdefault(request.node.nodeid, Grade())

    @pytest.fixture
    def seeds(self) -> Seeds:
        """Make numbers from the instructor's secret."""
        return Seeds(self.job.seed)

    @pytest.fixture
    def student(self, request: pytest.FixtureRequest) -> Student:
        """Give the student's work on the exercise of this test's file."""
        exercise = request.module.EXERCISE
        if exercise not in self.submission.notebooks:
            reason = self.submission.problems.get(exercise)
            raise NotSubmittedError(reason or f"There is no notebook of Exercise {exercise}.")
        if exercise not in self._students:
            self._students[exercise] = Student(
                self.open_notebook(exercise), self.limits.call_s, ros=self.job.ros
            )
        return self._students[exercise]

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item, call: pytest.CallInfo[None]
    ) -> Iterator[None]:
        """Keep what came of a cell or of a hidden test."""
        report = yield
        if call.excinfo and isinstance(call.excinfo.value, SandboxError):
            self.broken = call.excinfo.value
            item.session.shouldstop = "the sandbox fails"
        if isinstance(item, IPyNbCell):
            if call.when == "call":
                self._keep_cell(item, call)
        elif call.when == "call" or (call.when == "setup" and call.excinfo):
            self.results.append(self._result(item, call))
        return report

    def _keep_cell(self, item: Any, call: pytest.CallInfo[None]) -> None:  # noqa: ANN401
        outputs = item.test_outputs or []
        notebook = self.open_notebook(item.parent.exercise)
        death = notebook.reason_of_death()
        error = _cell_error(outputs, call.excinfo.value, death) if call.excinfo else None
        if error and notebook.overdue:
            error = _TOO_LONG
        seen = len(notebook.pictures)
        notebook.record(outputs, error)
        item.test_outputs = None
        item.parent.timed_out = False  # later cells have a living kernel again
        for picture in notebook.pictures[seen:_SHOWN_PICTURES]:
            scale = min(1.0, _WIDEST / max(picture.shape[:2]))
            size = [max(1, round(side * scale)) for side in picture.shape[1::-1]]
            small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
            caption = f"Exercise {item.parent.exercise}, cell {len(notebook.cells)}"
            self.pictures.append(Picture(caption, cv2.imencode(".png", small)[1].tobytes()))

    def _result(self, item: pytest.Item, call: pytest.CallInfo[None]) -> TestResult:
        worth, number, title = _points(item)
        grade = self._grades.get(item.nodeid) or Grade()
        error = call.excinfo.value if call.excinfo else None
        if isinstance(error, StudentError):
            grade.lose(str(error))
        elif error is not None and not isinstance(error, GradeFailed):
            # What came back broke the test, or the test is broken: an instructor must look.
            grade.lose("This could not be checked; your instructor has been told.")
            self.events.append(
                f"test {number} broke: {type(error).__name__}: {clean(str(error), 300)}"
            )
        self.scenes += grade.scenes
        status: Status = "partial"
        if grade.fraction in {0.0, 1.0}:
            status = "passed" if grade.fraction else "failed"
        if error is not None and not isinstance(error, StudentError | GradeFailed):
            status = "not_checked"
        return TestResult(
            name=title,
            number=number,
            score=round(worth * grade.fraction, 2),
            max_score=worth,
            output="\n".join(map(clean, grade.messages)),
            status=status,
            seconds=round(call.duration, 3),
        )


def _points(item: pytest.Item) -> tuple[float, str, str]:
    mark = item.get_closest_marker("points")
    if mark is None:
        raise pytest.UsageError(f"{item.nodeid} says nothing about its points")
    worth, number, title = mark.args
    return float(worth), str(number), str(title)


class _SandboxedFile(IPyNbFile):  # type: ignore[misc]
    """A notebook that nbval executes in a sandboxed kernel."""

    grading: Grading
    exercise: str

    def collect(self) -> Iterator[IPyNbCell]:
        """Collect every code cell; no tag or comment talks nbval out of running one."""
        for cell in super().collect():
            cell.options = defaultdict(bool)
            yield cell

    def setup(self) -> None:
        """Bring the kernel."""
        self.kernel = NbvalKernel(self.grading.open_notebook(self.exercise))

    def teardown(self) -> None:
        """Leave the kernel running: the hidden tests will question it."""


def _cell_error(outputs: list[Any], error: BaseException, death: str) -> str:
    for output in outputs:
        if output.get("output_type") == "error":
            kind = clean(str(output.get("ename", "")), 100)
            if kind == "NotImplementedError":
                return "is not done yet"
            if kind == "KeyboardInterrupt":
                return _TOO_LONG
            message = clean(str(output.get("evalue", "")), 500).rstrip(". \n")
            return f"raised {kind}: {message}.{hint(kind, message)}".rstrip(".")
    if isinstance(error, NbCellError):
        return _TOO_LONG
    if isinstance(error, KernelGoneError):
        why = clean(str(error), 200) or death
        return f"ended its process ({why})" if why else "ended its process"
    return "could not be executed"
