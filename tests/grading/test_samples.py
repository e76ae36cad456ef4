"""Right submissions get every point, in whatever style; a mistake costs its part and is named."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import pytest

from course_lib.grading.messages import Settings
from course_lib.grading.pool import Pool, usable_cpus
from course_lib.grading.runner import Options, grade_class
from course_lib.grading.sandbox import Limits

if TYPE_CHECKING:
    from course_lib.grading.messages import Finished
    from course_lib.grading.results import SubmissionResult, TestResult
    from course_lib.grading.runner import Outcome

SAMPLES = Path(__file__).with_name("samples")
TESTS = Path(__file__).parents[1] / "hidden"
sys.path.append(str(SAMPLES))
import build  # noqa: E402

# The first test grades them all: two minutes on two idle processors, far more on busy ones.
pytestmark = pytest.mark.timeout(1800)

CORRECT, MISTAKES = build.names("correct"), build.names("mistakes")
# Limits count seconds, not work: on a busy machine honest work takes many times as long. What never
# ends is to cost these tests seconds all the same, so it is graded by itself.
PATIENT = Limits(wall_s=1500, cell_s=300, call_s=150)
SHORT = Limits(wall_s=240, cell_s=30, call_s=10)
# All of them in both sandboxes take half an hour: `make test-samples`. Every other run grades what
# is right and some of the mistakes in one; in the other, what must not differ: right is right.
ALL = os.environ.get("COURSE_ALL_SAMPLES") == "1"
SOME = [name for name in MISTAKES if ALL or build.expected(name).get("every_run")]
GRADED = {"bubblewrap": [*CORRECT, *SOME], "sandlock": CORRECT if ALL else CORRECT[:3]}
RIGHT = [(sandbox, name) for sandbox in GRADED for name in CORRECT if name in GRADED[sandbox]]


class Class(NamedTuple):
    """What grading all samples in one sandbox came to."""

    failures: dict[str, str]
    results: dict[str, SubmissionResult]


class Kept:
    """Takes the place of the progress bar and keeps the results."""

    def __init__(self) -> None:
        self.results: dict[str, SubmissionResult] = {}

    def start(self, total: int, outcome: Outcome) -> None:
        pass

    def started(self, student: str) -> None:
        pass

    def finished(self, event: Finished) -> None:
        self.results[event.result.student] = event.result

    def stop(self) -> None:
        pass


@pytest.fixture(scope="module")
def graded(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Class]:
    """Grade the samples as `course grade` does, in each sandbox."""
    classes = {}
    for sandbox, names in GRADED.items():
        kept, failures = Kept(), {}
        started = time.monotonic()
        endless = [name for name in names if build.expected(name).get("never_ends")]
        for limits, some in ((PATIENT, set(names) - set(endless)), (SHORT, endless)):
            root = tmp_path_factory.mktemp(sandbox)
            for name in some:
                build.build(name, root / "in" / _student(name))
            settings = Settings(
                seed=b"a seed of these tests",
                tests=TESTS,
                exercises=("4.1", "4.2"),
                sandbox=sandbox,
                limits=limits,
            )
            if some:
                options = Options(root / "in", root / "out", settings)
                failures |= grade_class(options, Pool(settings, usable_cpus()), kept).failures
        print(f"{sandbox}: {len(names)} samples in {time.monotonic() - started:.0f} s")
        classes[sandbox] = Class(failures, kept.results)
    return classes


def _student(name: str) -> str:
    return name.replace("/", " ")


def _tests(found: Class, name: str) -> dict[str, TestResult]:
    """Give the tests of the exercises that a sample is about."""
    wanted = tuple(build.expected(name)["exercises"])
    tests = found.results[_student(name)].tests
    return {test.number: test for test in tests if test.number.startswith(wanted)}


def _lost(tests: dict[str, TestResult]) -> dict[str, str]:
    return {n: test.output for n, test in tests.items() if test.score < test.max_score}


def test_there_are_enough_samples():
    assert len(CORRECT) >= 12
    assert len(MISTAKES) >= 25


@pytest.mark.parametrize("sandbox", GRADED)
def test_the_grader_itself_never_fails(graded, sandbox):
    found = graded[sandbox]
    assert found.failures == {}
    assert len(found.results) == len(GRADED[sandbox])
    broken = [r.student for r in found.results.values() if any("broke" in e for e in r.events)]
    assert broken == []


@pytest.mark.parametrize(("sandbox", "name"), RIGHT)
def test_what_is_right_gets_every_point(graded, sandbox, name):
    tests = _tests(graded[sandbox], name)
    events = graded[sandbox].results[_student(name)].events
    assert tests
    assert _lost(tests) == {}, events
    assert not events


@pytest.mark.parametrize("name", SOME)
def test_a_mistake_costs_its_part_and_is_named(graded, name):
    expected = build.expected(name)
    tests = _tests(graded["bubblewrap"], name)
    result = graded["bubblewrap"].results[_student(name)]
    lost = _lost(tests)
    loses = set(expected.get("loses", ()))
    assert loses <= lost.keys(), lost
    keeps = expected.get("keeps", ())
    kept = tests.keys() - loses if keeps == "others" else set(keeps)
    assert not kept & lost.keys(), lost
    full = sum(test.max_score for test in tests.values())
    least, most = expected.get("points", (full, full))
    assert least <= sum(test.score for test in tests.values()) <= most, lost
    read = "\n".join([*(test.output for test in tests.values()), *result.notes]).lower()
    for words in expected["says"]:
        assert words.lower() in read
    for words in expected.get("events", ()):
        assert words.lower() in "\n".join(result.events).lower()


@pytest.mark.parametrize("name", SOME)
def test_a_mistake_is_a_mistake(name):
    """A sample without a price, or without words to its student, would show nothing."""
    expected = build.expected(name)
    assert expected["says"]
    assert expected["title"]
    told_only = "costs nothing" in expected["title"]
    assert told_only or expected["points"][1] < 10 * len(expected["exercises"])
