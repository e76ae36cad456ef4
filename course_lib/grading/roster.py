"""Reads a roster that Canvas or Moodle exported, and finds each submission's student in it."""

from __future__ import annotations

import csv
import io
import re
import unicodedata
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path

_IDS = {
    *("id", "sis user id", "sis login id", "integration id"),
    *("identifier", "id number", "email address", "email", "username"),
}
_NAMES = {"student", "full name", "name"}
_MOST_BYTES = 32 * 1024**2


@dataclass
class Roster:
    """A table of students.

    Attributes
    ----------
    header : list of str
    rows : list of list of str
        Each as long as the header.
    """

    header: list[str]
    rows: list[list[str]]

    def columns(self, names: Iterable[str]) -> list[int]:
        """Return the columns with one of these names, in lower case."""
        wanted = set(names)
        return [i for i, title in enumerate(self.header) if title.strip().casefold() in wanted]

    def column(self, name: str, *, like: str = r"(?!)") -> int:
        """Return a column by its name or by a pattern for it; added when there is none."""
        for index, title in enumerate(self.header):
            if title.strip() == name or re.fullmatch(like, title.strip()):
                return index
        self.header.append(name)
        for row in self.rows:
            row.append("")
        return len(self.header) - 1

    def fill_maximum(self, column: int, text: str) -> None:
        """Write into Canvas's row of points possible, unless something stands there."""
        for row in self.rows:
            if row[0].strip().casefold() == "points possible" and not row[column].strip():
                row[column] = text

    def guarded(self, row: Sequence[str], guard: Callable[[str], str]) -> list[str]:
        """Guard a row's names; what identifies a student must stay as it is."""
        names = self.columns(_NAMES)
        return [guard(cell) if i in names else cell for i, cell in enumerate(row)]


@dataclass
class Matching:
    """Who is who.

    Attributes
    ----------
    rows : dict
        Index of a submission to index of a row.
    unmatched : dict
        Index of a submission to why it has no row.
    """

    rows: dict[int, int] = field(default_factory=dict)
    unmatched: dict[int, str] = field(default_factory=dict)


def read(path: Path) -> Roster:
    """Read a roster, whatever program last saved it.

    Raises
    ------
    ValueError
        The file is no table of students.
    """
    raw = path.read_bytes()
    if len(raw) > _MOST_BYTES:
        raise ValueError(f"{path} is too large for a roster")
    text = _decoded(raw)
    first = text.partition("\n")[0]
    delimiter = max(",;\t", key=first.count)
    try:
        table = [
            row for row in csv.reader(io.StringIO(text, newline=""), delimiter=delimiter) if row
        ]
    except csv.Error as error:
        raise ValueError(f"{path} is no CSV file: {error}") from error
    if not table:
        raise ValueError(f"{path} is empty")
    header, *rows = table
    width = max(map(len, table))
    roster = Roster(
        header + [""] * (width - len(header)), [r + [""] * (width - len(r)) for r in rows]
    )
    if not roster.columns(_IDS | _NAMES):
        raise ValueError(
            f"{path} has no column that names students, such as ID, SIS Login ID, Student, "
            "Identifier or Full name"
        )
    return roster


def match(roster: Roster, submissions: Sequence[str]) -> Matching:
    """Find each submission's student; one who cannot be told for sure is left out.

    Parameters
    ----------
    roster : Roster
    submissions : sequence of str
        Their names: an identifier, a login, a name, or what Canvas calls a downloaded file.
    """
    by_id, by_name = _keys(roster)
    matching = Matching()
    claims: defaultdict[int, list[int]] = defaultdict(list)
    for index, submission in enumerate(submissions):
        rows = _rows(submission, by_id, by_name)
        if not rows:
            # Intake adds this to a name that it had to change.
            rows = _rows(re.sub(r"-[0-9a-f]{6}$", "", submission), by_id, by_name)
        if len(rows) == 1:
            claims[min(rows)].append(index)
        else:
            matching.unmatched[index] = (
                f"fits {len(rows)} students" if rows else "not in the roster"
            )
    for row, claimed in claims.items():
        if len(claimed) == 1:
            matching.rows[claimed[0]] = row
            continue
        for index in claimed:
            matching.unmatched[index] = "fits the same student as another submission"
    matching.unmatched = dict(sorted(matching.unmatched.items()))
    return matching


_Keys = dict[str, set[int]]


def _keys(roster: Roster) -> tuple[_Keys, _Keys]:
    by_id: defaultdict[str, set[int]] = defaultdict(set)
    by_name: defaultdict[str, set[int]] = defaultdict(set)
    ids, names = roster.columns(_IDS), roster.columns(_NAMES)
    for index, row in enumerate(roster.rows):
        if row[0].strip().casefold() == "points possible":
            continue
        for column in ids:
            key = row[column].strip().casefold()
            # A login may be an address, of which the folder bears the first part.
            for variant in {key, key.partition("@")[0]} - {""}:
                by_id[variant].add(index)
        for column in names:
            words = _words(row[column])
            for variant in {" ".join(sorted(words)), "".join(words)} - {""}:
                by_name[variant].add(index)
    return dict(by_id), dict(by_name)


def _rows(submission: str, by_id: _Keys, by_name: _Keys) -> set[int]:
    """Return the rows that fit, by the surest sign there is."""
    words = _words(submission)
    if not words:
        return set()
    key = submission.strip().casefold()
    # Canvas calls a downloaded file ngzoe_LATE_4711_90210_exercise.
    parts = [part for part in key.split("_") if part]
    signs = [
        by_id.get(key),
        by_name.get(" ".join(sorted(words))),
        by_name.get("".join(words)),
        *(by_id.get(part) for part in parts if len(parts) > 1 and part.isdecimal()),
        by_name.get("".join(_words(parts[0]))) if parts else None,
    ]
    return next((rows for rows in signs if rows), set())


def _words(text: str) -> list[str]:
    """Cut a name into words, without accents and capitals."""
    plain = unicodedata.normalize("NFKD", text)
    kept = "".join(c for c in plain if not unicodedata.combining(c)).casefold()
    return re.findall(r"[^\W_]+", kept)


def _decoded(raw: bytes) -> str:
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        return raw.decode("utf-16", errors="replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")
