"""Jobs and results as plain data, for the way between the grader's own processes."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.grading.results import Picture, SubmissionResult, TestResult
from course_lib.grading.sandbox.limits import Limits

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from course_lib.grading.session import Job

GRADE = "course_lib.grading.session:grade_one"


@dataclass(frozen=True)
class Settings:
    """What all submissions of a run have in common.

    Attributes
    ----------
    seed : bytes
        The instructor's secret.
    tests : Path
        The folder of hidden tests.
    exercises : tuple of str
    sandbox : str
        See `sandbox.choose`.
    limits : Limits
    grade : str
        ``module:function`` that grades a `session.Job` with a `sandbox.Launcher`. The seam by which
        tests of the runner put something else in the session's place.
    grace_s : float
        How long after ``limits.wall_s`` the grading itself is given up.
    own_bytes : int
        Memory of the grader's own part of grading one submission; it needs a tenth.
    ros : bool
        Whether students' nodes run on real ROS instead of `offline_ros`.
    """

    seed: bytes = field(repr=False)
    tests: Path
    exercises: tuple[str, ...]
    sandbox: str
    limits: Limits = field(default_factory=Limits)
    grade: str = GRADE
    grace_s: float = 60.0
    own_bytes: int = 6 * 2**30
    ros: bool = False

    def to_data(self) -> dict[str, Any]:
        """Give JSON's own types."""
        return asdict(self) | {"seed": self.seed.hex(), "tests": str(self.tests)}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Settings:
        """Read what `to_data` gave."""
        changed = {
            "seed": bytes.fromhex(data["seed"]),
            "tests": Path(data["tests"]),
            "exercises": tuple(data["exercises"]),
            "limits": Limits(**data["limits"]),
        }
        return cls(**{**data, **changed})


@dataclass(frozen=True)
class Task:
    """One submission of a run.

    Attributes
    ----------
    student : str
    paths : tuple of Path
        As in `submission.Source`.
    fingerprint : str
        Goes into the result.
    given_up : str
        Why it is not to be graded but reported as not checked; empty for most.
    """

    student: str
    paths: tuple[Path, ...]
    fingerprint: str = ""
    given_up: str = ""

    def to_data(self) -> dict[str, Any]:
        """Give JSON's own types."""
        return asdict(self) | {"paths": [str(path) for path in self.paths]}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Task:
        """Read what `to_data` gave."""
        return cls(**{**data, "paths": tuple(map(Path, data["paths"]))})

    def job(self, settings: Settings) -> Job:
        """Give what the session asks for."""
        from course_lib.grading.session import Job  # noqa: PLC0415  (imports cv2, pytest, nbval)

        return Job(
            student=self.student,
            paths=self.paths,
            seed=settings.seed,
            exercises=settings.exercises,
            tests=settings.tests,
            fingerprint=self.fingerprint,
            ros=settings.ros,
        )


@dataclass(frozen=True)
class Started:
    """A worker has begun with a submission."""

    student: str


@dataclass(frozen=True)
class Finished:
    """A submission's result is there.

    Attributes
    ----------
    result : SubmissionResult
    failure : str
        Why the grader itself could not grade it; empty when it could.
    """

    result: SubmissionResult
    failure: str = ""


_PICTURES = ("pictures", "scenes")


def to_message(result: SubmissionResult) -> tuple[dict[str, Any], list[bytes]]:
    """Give a result as JSON's own types and blobs."""
    data: dict[str, Any] = {}
    blobs: list[bytes] = []
    for part in fields(result):
        value = getattr(result, part.name)
        if part.name in _PICTURES:
            data[part.name] = [picture.caption for picture in value]
            blobs += [picture.png for picture in value]
        elif part.name == "tests":
            data["tests"] = [asdict(test) for test in value]
        elif part.name == "code":
            data["code"] = {name: sorted(marks) for name, marks in value.items()}
        else:
            data[part.name] = value
    return data, blobs


def from_message(data: Mapping[str, Any], blobs: Sequence[bytes]) -> SubmissionResult:
    """Read what `to_message` gave."""
    pictures = iter(blobs)
    known = dict(data)
    for name in _PICTURES:
        known[name] = tuple(Picture(caption, next(pictures)) for caption in data[name])
    known["tests"] = tuple(TestResult(**test) for test in data["tests"])
    known["code"] = {name: frozenset(marks) for name, marks in data["code"].items()}
    known["notes"], known["events"] = tuple(data["notes"]), tuple(data["events"])
    return SubmissionResult(**known)
