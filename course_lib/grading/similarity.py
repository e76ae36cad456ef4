"""Finds submissions whose code is nearly the same, whatever its variables are called.

Winnowing, after Schleimer, Wilkerson and Aiken, "Winnowing: local algorithms for document
fingerprinting", SIGMOD 2003: hash every run of `RUN` tokens, and keep the smallest hash of every
`WINDOW` runs. Whatever two submissions share over `RUN` + `WINDOW` - 1 tokens is found for sure.
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
import zlib
from collections import Counter, defaultdict
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.grading.code_tokens import tokens

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from collections.abc import Set as AbstractSet

RUN = 12
WINDOW = 6
# Fewer fingerprints of one's own say nothing: there are not that many ways to write three lines.
FEWEST = 24
ALIKE = 0.5
# More than any honest exercise holds: a flood costs neither time nor space.
_MOST_CHARACTERS = 200_000
_MOST_MARKS = 3000
_ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Group:
    """Submissions whose code is nearly the same.

    Attributes
    ----------
    students : tuple of str
        At least two, sorted.
    alike : float
        From 0 to 1: how much of the shorter code stands in the longer, for the closest pair.
    """

    students: tuple[str, ...]
    alike: float


def fingerprints(code: Path | Sequence[str]) -> frozenset[int]:
    """Fingerprint code.

    Names of variables, numbers, comments, blanks, imports, docstrings and the order of cells do
    not matter; broken code and magics do not disturb.

    Parameters
    ----------
    code : Path or sequence of str
        A notebook, a Python file, or the code of each cell.

    Returns
    -------
    frozenset of int
        32-bit numbers; none when there is nothing to read.
    """
    cells = _cells(code) if isinstance(code, Path) else code
    marks: set[int] = set()
    left = _MOST_CHARACTERS
    for cell in cells:
        # A cell at a time: so cells may change places.
        marks.update(_winnow(_hashes(tokens(cell[:left]))))
        left -= len(cell)
        if left <= 0:
            break
    # Of too many, the smallest: the same choice in everybody's.
    return frozenset(sorted(marks)[:_MOST_MARKS])


def of_submission(
    notebooks: Mapping[str, Path], package: Path | None = None
) -> dict[str, frozenset[int]]:
    """Fingerprint a submission's code; `own` leaves out what the course has published.

    Parameters
    ----------
    notebooks : mapping of str to Path
        Exercise ("4.1") to notebook.
    package : Path, optional
        The ROS package; its Python files count for exercise 4.2.

    Returns
    -------
    dict
        Exercise to fingerprints.
    """
    found = {name: fingerprints(path) for name, path in notebooks.items()}
    if package is not None:
        nodes = sorted(path for path in package.rglob("*.py") if path.is_file())[:20]
        found["4.2"] = found.get("4.2", frozenset[int]()).union(*map(fingerprints, nodes))
    return found


def own(code: Mapping[str, AbstractSet[int]]) -> dict[str, frozenset[int]]:
    """Leave out of what `of_submission` gave what everybody has.

    Parameters
    ----------
    code : mapping of str to set of int
        Exercise to fingerprints.

    Returns
    -------
    dict
        The same without those of `published`, as `report.write_student` takes it.
    """
    return {exercise: frozenset(marks) - published() for exercise, marks in code.items()}


@lru_cache(maxsize=1)
def published(root: Path = _ROOT) -> frozenset[int]:
    """Return the fingerprints of the stubs, the lessons and the library: everybody has those.

    Here every run of tokens counts, not only the chosen ones, for what stands before and after
    decides which are chosen.
    """
    files = [
        *sorted(root.glob("exercises/**/*.ipynb")),
        *sorted(root.glob("exercises/**/*.py")),
        *sorted(root.glob("notebooks/*.ipynb")),
        *sorted(root.glob("course_lib/*.py")),
    ]
    return frozenset(
        number for path in files for cell in _cells(path) for number in _hashes(tokens(cell))
    )


def groups(marks: Mapping[str, AbstractSet[int]], *, alike: float = ALIKE) -> list[Group]:
    """Group submissions with nearly the same code.

    Parameters
    ----------
    marks : mapping of str to set of int
        Student to fingerprints.
    alike : float, optional
        How much of the shorter of two must stand in the other.

    Returns
    -------
    list of Group
        The closest first.
    """
    # The very same code many times over is one code, so that a whole class that hands in the same
    # file neither takes long nor passes for common knowledge.
    same: defaultdict[frozenset[int], list[str]] = defaultdict(list)
    for student, own in marks.items():
        if len(own) >= FEWEST:
            same[frozenset(own)].append(student)
    codes = list(same)
    holders: defaultdict[int, list[int]] = defaultdict(list)
    for index, own in enumerate(codes):
        for mark in own:
            holders[mark].append(index)
    # What a fifth of the class wrote, nobody needed to copy.
    common = max(10, len(codes) // 5)
    shared: Counter[tuple[int, int]] = Counter()
    rare: Counter[int] = Counter()
    for held_by in holders.values():
        if len(held_by) <= common:
            rare.update(held_by)
            shared.update(combinations(held_by, 2))
    pairs = {
        (a, b): count / min(rare[a], rare[b])
        for (a, b), count in shared.items()
        if min(rare[a], rare[b]) >= FEWEST and count >= alike * min(rare[a], rare[b])
    }
    return _join([same[own] for own in codes], pairs)


def pack(marks: AbstractSet[int]) -> str:
    """Write fingerprints as short text."""
    return base64.b64encode(struct.pack(f"<{len(marks)}I", *sorted(marks))).decode()


def unpack(text: str) -> frozenset[int]:
    """Read what `pack` wrote; what it did not write holds none."""
    try:
        data = base64.b64decode(text, validate=True)
        return frozenset(struct.unpack(f"<{len(data) // 4}I", data))
    except (binascii.Error, ValueError, struct.error):
        return frozenset()


def _join(students: list[list[str]], pairs: Mapping[tuple[int, int], float]) -> list[Group]:
    """Join pairs that touch each other."""
    leader = list(range(len(students)))

    def find(index: int) -> int:
        while leader[index] != index:
            leader[index] = index = leader[leader[index]]
        return index

    for a, b in pairs:
        leader[find(a)] = find(b)
    members: defaultdict[int, list[str]] = defaultdict(list)
    closest: defaultdict[int, float] = defaultdict(float)
    for index, names in enumerate(students):
        members[find(index)].extend(names)
        if len(names) > 1:
            closest[find(index)] = 1.0
    for (a, _), share in pairs.items():
        closest[find(a)] = max(closest[find(a)], share)
    joined = [
        Group(tuple(sorted(names)), closest[index])
        for index, names in members.items()
        if len(names) > 1
    ]
    return sorted(joined, key=lambda group: (-group.alike, group.students))


def _cells(path: Path) -> list[str]:
    """Return a file's code, cell by cell; none when it cannot be read."""
    try:
        text = path.read_text("utf-8", errors="replace")
        if path.suffix != ".ipynb":
            return [text]
        cells = json.loads(text)["cells"]
        sources = [cell["source"] for cell in cells if cell["cell_type"] == "code"]
        return ["".join(source) for source in sources]
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return []


def _hashes(found: Sequence[str]) -> list[int]:
    """Hash every run of tokens, in which each name is only the first, the second, the third."""
    hashes = []
    for start in range(len(found) - RUN + 1):
        order: dict[str, str] = {}
        run = [
            order.setdefault(token, f"n{len(order)}") if token[0] == "$" else token
            for token in found[start : start + RUN]
        ]
        hashes.append(zlib.crc32(" ".join(run).encode("utf-8", "replace")))
    return hashes


def _winnow(hashes: Sequence[int]) -> Iterable[int]:
    """Choose the smallest of every window; of code shorter than a window, the smallest of all."""
    for start in range(max(len(hashes) - WINDOW + 1, min(len(hashes), 1))):
        yield min(hashes[start : start + WINDOW])
