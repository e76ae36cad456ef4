"""Copied code is found under its disguises; what two people wrote by themselves is not copied."""

from __future__ import annotations

import itertools
import json
import re
import time

import numpy as np
import pytest
from independent_code import SOLUTIONS, STUB

from course_lib.grading.code_tokens import tokens
from course_lib.grading.similarity import (
    ALIKE,
    FEWEST,
    fingerprints,
    groups,
    of_submission,
    own,
    pack,
    published,
    unpack,
)

IGNORED = published() | fingerprints(STUB)


def marks(cells):
    return fingerprints(cells) - IGNORED


def rename(cells):
    """Give every variable of a solution another name, consistently."""
    fixed = {"sum", "len", "range", "print", "np", "cv2", "None", "return", "def", "for", "in"}
    names = {token[1:] for cell in cells for token in tokens(cell) if token[0] == "$"} - fixed
    table = {name: f"other_{index}" for index, name in enumerate(sorted(names))}
    pattern = re.compile(r"(?<!\.)\b(" + "|".join(map(re.escape, table)) + r")\b")
    return [pattern.sub(lambda m: table[m[1]], cell) for cell in cells]


def recomment(cells):
    changed = [re.sub(r"#.*", "", cell) for cell in cells]
    return [
        "# mine\n" + cell.replace("\n    ", "\n    # so that it works\n    ") for cell in changed
    ]


def reorder(cells):
    return [cells[i] for i in np.random.default_rng(4).permutation(len(cells))]


def respace(cells):
    return [re.sub(r"\s*([=+*,()])[ \t]*", r" \1 ", cell) for cell in cells]


DISGUISES = {
    "renamed variables": rename,
    "other comments": recomment,
    "other order of cells": reorder,
    "other blanks": respace,
    "other numbers": lambda cells: [re.sub(r"\b\d\d+\b", "77", cell) for cell in cells],
    "one cell": lambda cells: ["\n\n".join(cells)],
    "magics and plots added": lambda cells: ["%matplotlib inline\n!ls", *cells, "plt.plot([1, 2])"],
    "a broken cell": lambda cells: [*cells, "def f(:\n  '''"],
    "all of them": lambda cells: reorder(recomment(rename(cells))),
}


@pytest.mark.parametrize("disguise", DISGUISES)
@pytest.mark.parametrize("author", SOLUTIONS)
def test_a_disguised_copy_is_found(author, disguise):
    copy = DISGUISES[disguise](SOLUTIONS[author])
    found = groups({"author": marks(SOLUTIONS[author]), "copier": marks(copy)})
    assert [group.students for group in found] == [("author", "copier")]
    assert found[0].alike >= 0.75


def test_independent_solutions_are_not_grouped():
    own = {author: marks(cells) for author, cells in SOLUTIONS.items()}
    assert all(len(found) >= FEWEST for found in own.values()), "too short to be judged"
    assert groups(own) == []
    # And not by a hair.
    for (_, a), (_, b) in itertools.combinations(own.items(), 2):
        assert len(a & b) < 0.7 * ALIKE * min(len(a), len(b))


def test_the_stub_and_the_lessons_do_not_count(tmp_path):
    lesson = next(
        path for path in (published.__wrapped__.__defaults__[0] / "notebooks").glob("4_4*.ipynb")
    )
    assert fingerprints(lesson)
    assert fingerprints(lesson) - published() == frozenset()
    notebook = tmp_path / "exercise_4_1.ipynb"
    notebook.write_text(lesson.read_text())
    package = tmp_path / "unit4"
    package.mkdir()
    (package / "node.py").write_text("\n".join(SOLUTIONS["sift_ratio_magsac"]))
    found = own(of_submission({"4.1": notebook}, package))
    assert found["4.1"] == frozenset()
    assert found["4.2"] == fingerprints(package / "node.py") - published()
    assert len(found["4.2"]) >= FEWEST


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\xff\xfe\x00",
        b"[" * 100_000,
        b'{"cells": 4}',
        b'{"cells": [{"cell_type": "code", "source": 7}]}',
        b'{"cells": [4]}',
        json.dumps({"cells": [{"cell_type": "code", "source": None}]}).encode(),
    ],
)
def test_an_unreadable_notebook_has_no_fingerprints(tmp_path, content):
    path = tmp_path / "notebook.ipynb"
    path.write_bytes(content)
    assert fingerprints(path) == frozenset()


@pytest.mark.parametrize(
    "flood",
    [
        '"' * 10**6,
        "'''" * 10**6,
        "(" * 10**6,
        "\\" * 10**6,
        "from a import (" * 10**5,
        "from a import (\n" * 10**5,
        'f"{' * 10**6,
        "%\n" * 10**6,
        "\n".join(f"x{i} = {i}; y = f(x{i}, [{i}, x{i - 1}])" for i in range(10**5)),
    ],
)
def test_a_flood_of_code_takes_little_time_and_space(flood):
    started = time.process_time()
    found = fingerprints([flood])
    assert time.process_time() - started < 5
    assert len(pack(found)) <= 16_000


def test_five_hundred_submissions_are_compared_quickly():
    rng = np.random.default_rng(1)
    numbers = rng.choice(2**32, 100_000, replace=False).tolist()
    idioms, own = numbers[:400], iter(numbers[400:])
    class_ = {
        f"student {i:03}": {*rng.choice(idioms, 60).tolist(), *itertools.islice(own, 120)}
        for i in range(497)
    }
    copied = sorted(class_["student 007"])
    class_["copier"] = {*copied[:150], *itertools.islice(own, 60)}
    started = time.process_time()
    found = groups(class_)
    assert time.process_time() - started < 10
    assert [group.students for group in found] == [("copier", "student 007")]


def test_a_class_that_hands_in_one_file_is_one_group():
    own = marks(SOLUTIONS["sift_ratio_magsac"])
    (group,) = groups({f"student {i:03}": own for i in range(300)})
    assert len(group.students) == 300
    assert group.alike == 1


def test_who_touches_the_same_source_is_in_one_group():
    source = list(range(1000, 1100))
    found = groups(
        {
            "a": {*source[:60]},
            "b": {*source[20:80]},
            "c": {*source[40:100]},
            "d": {*range(5000, 5100)},
        }
    )
    assert [group.students for group in found] == [("a", "b", "c")]


def test_little_code_is_never_a_copy():
    few = set(range(FEWEST - 1))
    assert groups({"a": few, "b": few}) == []


def test_fingerprints_survive_being_stored():
    own = marks(SOLUTIONS["sift_ratio_magsac"])
    assert unpack(pack(own)) == own
    assert unpack(pack(frozenset())) == frozenset()
    for damaged in ("?", "AAA", "AAAAAAA=", "é"):
        assert unpack(damaged) == frozenset()
