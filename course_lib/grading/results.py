"""What grading one submission yields: plain data between session, runner, report and exports."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Mapping

Status = Literal["passed", "partial", "failed", "not_checked"]


@dataclass(frozen=True)
class TestResult:
    """
    The outcome of one test.

    Attributes
    ----------
    name : str
        What the test asks, in a student's words.
    number : str
        Its place in the rubric, such as ``"4.1.3"``.
    score, max_score : float
        Points.
    output : str
        What the student reads: what is wrong and how to mend it. Plain text.
    status : str
        ``not_checked`` when the test could not be run, for example because the kernel had died.
    visibility : str
        Gradescope's word for who sees it.
    seconds : float
        How long it took.
    """

    __test__ = False  # not a test class for pytest

    name: str
    number: str
    score: float
    max_score: float
    output: str
    status: Status
    visibility: str = "visible"
    seconds: float = 0.0


@dataclass(frozen=True)
class Picture:
    """A picture with a caption: the bytes of a PNG or JPEG that the grader itself encoded."""

    caption: str
    png: bytes


@dataclass(frozen=True)
class SubmissionResult:
    """
    Everything that grading one submission yields.

    Attributes
    ----------
    student : str
        The submission's name.
    tests : tuple of TestResult
    notes : tuple of str
        What was noticed and forgiven on intake: a renamed file, a repaired cell.
    events : tuple of str
        What an instructor should look at: a limit that was hit, an attempt to use the network.
    pictures : tuple of Picture
        What the student's notebook drew.
    scenes : tuple of Picture
        For the instructor only: held-out scenes with the true and the found outline.
    code : mapping of str to frozenset of int
        Exercise to what `similarity.of_submission` says of its code.
    fingerprint : str
        Hash of submission, seed, tests and library: equal means nothing to grade anew.
    seconds : float
        Wall clock.
    """

    student: str
    tests: tuple[TestResult, ...]
    notes: tuple[str, ...] = ()
    events: tuple[str, ...] = ()
    pictures: tuple[Picture, ...] = field(default=(), repr=False)
    scenes: tuple[Picture, ...] = field(default=(), repr=False)
    code: Mapping[str, frozenset[int]] = field(default_factory=dict, repr=False)
    fingerprint: str = ""
    seconds: float = 0.0

    @property
    def score(self) -> float:
        """Points reached."""
        return sum(test.score for test in self.tests)

    @property
    def max_score(self) -> float:
        """Points that could be reached."""
        return sum(test.max_score for test in self.tests)
