"""
Every hostile and broken sample, beside a neighbour who must not notice.

All of them under both sandboxes take a quarter of an hour and more: `make test-samples`. Every
other run tries some of each kind.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from course_lib.grading.sandbox import Limits

from hostile_desk import CANARY, Desk, Graded, builder  # isort: skip

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
QUICK = HERE / "quick_hidden"
LIMITS = Limits(
    wall_s=90,
    cell_s=8,
    call_s=4,
    cpu_s=20,
    memory_bytes=700 * 2**20,
    processes=24,
    file_bytes=16 * 2**20,
    disk_bytes=32 * 2**20,
    output_bytes=8 * 2**20,
)
build = builder()
SAMPLES = build.names("hostile")
ALL = os.environ.get("COURSE_ALL_SAMPLES") == "1"
# What every run tries: some of each kind, none of those that wait for a limit of time.
EVERY_RUN = {
    "bubblewrap": (
        *("abuses_its_sockets", "asks_for_input", "broken_archives", "cell_deleted", "daemon"),
        *("daemon_without_a_head", "deep_json", "empty_file", "fills_the_disk"),
        *("floods_below_python", "forks_200", "huge_source", "imports_the_grader"),
        "kills_everybody",
    ),
    "sandlock": (
        *("a_million_parts", "ansi_and_html", "binary_file", "burns_processors"),
        *("daemon_of_a_strange_name", "deep_folders"),
    ),
}
CASES = [
    (sandbox, name)
    for sandbox, some in EVERY_RUN.items()
    for name in (SAMPLES if ALL else [f"hostile/{each}" for each in some])
]
PROOF = Path("/tmp/GOT_THROUGH")  # noqa: S108  (where samples would write it)
_MARKUP = re.compile(r"<(script|img|svg|b)\b[^>]*(onerror|onload|alert|owned)", re.IGNORECASE)
_CODES = re.compile("[\x1b\u202e]")


@pytest.fixture(scope="module")
def desks(tmp_path_factory) -> Iterator[Callable[[str, Path], Desk]]:
    """Give the desk for a sandbox and a folder of hidden tests."""
    neighbour = tmp_path_factory.mktemp("neighbour")
    (neighbour / "neighbour").mkdir()
    script = build.PLAIN.read_text() + f"# %%\n# {CANARY}-neighbour\n"
    build.nbformat.write(build.notebook(script), neighbour / "neighbour" / "exercise_4_1.ipynb")
    opened: dict[tuple[str, Path], Desk] = {}
    with ExitStack() as stack:

        def desk(sandbox: str, tests: Path) -> Desk:
            key = sandbox, tests
            if key not in opened:
                opened[key] = stack.enter_context(Desk(sandbox, LIMITS, tests, neighbour))
            return opened[key]

        yield desk


@pytest.mark.parametrize(("sandbox", "name"), CASES)
def test_it_is_contained(desks, tmp_path, sandbox, name):
    expected = build.expected(name)
    desk = desks(sandbox, ROOT / expected["hidden"] if "hidden" in expected else QUICK)
    build.build(name, tmp_path / "in" / Path(name).name)
    graded = desk.grade(tmp_path / "in")
    print(f"{graded.seconds:.1f} s", graded.told["score"], graded.finished.result.events)
    print([f"{t:.1f}" for _, _, t in graded.neighbours], f"{desk.alone:.1f}")
    for test in graded.finished.result.tests:
        print(test.number, test.score, test.max_score, test.output)
    _has_its_result(expected, graded)
    _let_nothing_out(graded)
    assert all(reached == possible - 2 for reached, possible, _ in graded.neighbours)
    slow = max(seconds for _, _, seconds in graded.neighbours)
    assert slow < 6 * desk.alone + 10, "the neighbour had to wait"
    assert graded.left == set()


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
        assert "GOT THROUGH" not in text
        assert CANARY not in text
        assert not _CODES.search(text)
    assert not _MARKUP.search(graded.pages)
    assert not PROOF.exists()
