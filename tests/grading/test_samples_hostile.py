"""
Every hostile and broken sample, beside a neighbour who must not notice.

A sample names limits of its own where it would otherwise wait long for one. Every run grades every
fourth sample, by turns in one of the sandboxes; `make test-samples` grades each in both.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from course_lib.grading.sandbox import Limits

from hostile_desk import CANARY, QUICK, Desk, Graded, builder  # isort: skip

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
# Seconds of the clock are for what never ends: a busy machine must not use them up.
LIMITS = Limits(
    wall_s=200,
    cell_s=40,
    call_s=20,
    cpu_s=20,
    memory_bytes=700 * 2**20,
    processes=24,
    file_bytes=16 * 2**20,
    disk_bytes=32 * 2**20,
    output_bytes=16 * 2**20,
)
build = builder()
SANDBOXES = ("bubblewrap", "sandlock")
ALL = os.environ.get("COURSE_ALL_SAMPLES") == "1"
CASES = [
    (sandbox, name)
    for turn, sandbox in enumerate(SANDBOXES)
    for number, name in enumerate(build.names("hostile"))
    if ALL or number % (4 * len(SANDBOXES)) == 4 * turn
]
PROOF = Path("/tmp/GOT_THROUGH")  # noqa: S108  (where samples would write it)
_MARKUP = re.compile(r"<(script|img|svg|b)\b[^>]*(onerror|onload|alert|owned)", re.IGNORECASE)
_DATA = re.compile("data:image/[a-z]+;base64,[A-Za-z0-9+/=]*")  # any word may be in there
_CODES = re.compile("[\x1b\u202e]")


@pytest.fixture(scope="module")
def desks(tmp_path_factory) -> Iterator[Callable[[str], Desk]]:
    """Give the desk of a sandbox; at its end the neighbour has all its points, and nothing is left.

    One at a time, as a machine with two processors has room for no more.
    """
    neighbour = tmp_path_factory.mktemp("neighbour")
    (neighbour / "neighbour").mkdir()
    script = build.PLAIN.read_text() + f"# %%\n# {CANARY}-neighbour\n"
    build.nbformat.write(build.notebook(script), neighbour / "neighbour" / "exercise_4_1.ipynb")
    opened: dict[str, Desk] = {}

    def close() -> None:
        for desk in opened.values():
            with desk:
                left = desk.settle()
            assert left == set()
            _leaves_the_neighbour_alone(desk)

    def desk(sandbox: str) -> Desk:
        if sandbox not in opened:
            close()
            opened.clear()
            opened[sandbox] = Desk(sandbox, neighbour)
        return opened[sandbox]

    yield desk
    close()


@pytest.mark.parametrize(("sandbox", "name"), CASES)
def test_it_is_contained(desks, tmp_path, sandbox, name):
    expected = build.expected(name)
    desk = desks(sandbox)
    build.build(name, tmp_path / "in" / Path(name).name)
    limits = replace(LIMITS, **expected.get("limits", {}))
    hidden = ROOT / expected["hidden"] if "hidden" in expected else QUICK
    graded = desk.grade(tmp_path / "in", hidden, limits)
    print(f"{graded.seconds:.1f} s", graded.told["score"], graded.finished.result.events)
    print(f"alone {desk.alone:.1f} s", desk.beside)
    for test in graded.finished.result.tests:
        print(test.number, test.score, test.max_score, test.output)
    _has_its_result(expected, graded)
    _let_nothing_out(graded)
    _leaves_the_neighbour_alone(desk)
    assert graded.left == set()


def _leaves_the_neighbour_alone(desk: Desk) -> None:
    """Judge the neighbour's gradings that have ended, each once."""
    ended, desk.beside = desk.beside, []
    for beside in ended:
        assert beside.reached == beside.possible - 2, beside.samples  # it has no Exercise 4.2
        assert beside.seconds < 6 * desk.alone + 30, f"it had to wait for {beside.samples}"


def _has_its_result(expected: dict, graded: Graded) -> None:
    result = graded.finished.result
    assert graded.finished.failure == ""
    wanted = expected.get("exercises", ["4.1"])
    tests = [test for test in result.tests if test.number[:3] in wanted]
    assert tests
    assert all(test.status != "not_checked" for test in tests), result.events
    reached, possible = sum(t.score for t in tests), sum(t.max_score for t in tests)
    low, high = expected.get("points", [possible, possible])
    assert low <= reached <= high
    lost = {test.number for test in tests if test.score < test.max_score}
    assert set(expected.get("loses", [])) <= lost
    said = "\n".join([*(test.output for test in tests), *result.notes]).lower()
    for words in expected.get("says", []):
        assert words.lower() in said
    seen = "\n".join(result.events).lower()
    for words in expected.get("events", []):
        assert words.lower() in seen
    shown = [test for test in graded.told["tests"] if test["number"][:3] in wanted]
    assert round(sum(test["score"] for test in shown), 2) == round(reached, 2)


def _let_nothing_out(graded: Graded) -> None:
    for text in (graded.pages, json.dumps(graded.told, ensure_ascii=False)):
        for secret in ("GOT THROUGH", CANARY):
            at = text.find(secret)
            assert at < 0, text[at - 300 : at + 300]
        assert not _CODES.search(text)
    found = _MARKUP.search(_DATA.sub("", graded.pages))
    assert found is None, found
    assert not PROOF.exists()
