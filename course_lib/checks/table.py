"""What a check found: rows of right, not right and not yet, for notebooks and terminals."""

from __future__ import annotations

import html
import textwrap
from dataclasses import asdict, dataclass
from enum import Enum
from typing import Any

_WIDTH = 96
_INDENT = " " * 4
# Inherits the page's own colours, so it is legible on light and dark; the words say it all, colour
# only helps. GitHub drops styles and keeps the words.
_CELL = "text-align:left;vertical-align:top;padding:0.35em 0.8em;white-space:normal;"
_RULE = "border-top:1px solid rgba(128,128,128,0.35);"
_INK = {
    "right": "var(--jp-success-color0, inherit)",
    "not right": "var(--jp-error-color0, inherit)",
    "not yet": "inherit",
}


class Verdict(Enum):
    """What can come of one check."""

    RIGHT = "right"
    WRONG = "not right"
    NOT_YET = "not yet"

    @property
    def sign(self) -> str:
        """One character for it."""
        return {"right": "✓", "not right": "✗", "not yet": "…"}[self.value]


@dataclass(frozen=True)
class Row:
    """
    One thing that was checked.

    Attributes
    ----------
    function : str
        The student's function, or the file, that it is about.
    asks : str
        What it should do.
    verdict : Verdict
    help : str
        What to do about it; empty when it is right.
    """

    function: str
    asks: str
    verdict: Verdict
    help: str = ""


@dataclass(frozen=True)
class Table:
    """
    What came of all checks of an exercise; notebooks show it as a table.

    Attributes
    ----------
    exercise : str
        Such as "4.1".
    rows : tuple of Row
    """

    exercise: str
    rows: tuple[Row, ...]

    @property
    def is_right(self) -> bool:
        """Whether every check found it right."""
        return all(row.verdict is Verdict.RIGHT for row in self.rows)

    @property
    def summary(self) -> str:
        """One sentence about all rows."""
        right = sum(row.verdict is Verdict.RIGHT for row in self.rows)
        if right == len(self.rows):
            return (
                f"Exercise {self.exercise}: all {right} right."
                if right > 1
                else (f"Exercise {self.exercise}: right.")
            )
        return f"Exercise {self.exercise}: {right} of {len(self.rows)} right."

    def __repr__(self) -> str:
        lines = [self.summary]
        for row in self.rows:
            lines.append(f"  {row.verdict.sign} {row.verdict.value}: {row.function}: {row.asks}")
            if row.help:
                lines += textwrap.wrap(
                    row.help, _WIDTH, initial_indent=_INDENT, subsequent_indent=_INDENT
                )
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        body = "".join(self._html_row(row) for row in self.rows)
        heads = ("", "what", "what it should do")
        head = "".join(f'<th scope="col" style="{_CELL}">{text}</th>' for text in heads)
        return (
            '<table style="border-collapse:collapse;background:transparent;color:inherit">'
            f'<caption style="text-align:left;font-weight:bold">{html.escape(self.summary)}'
            f"</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        )

    @staticmethod
    def _html_row(row: Row) -> str:
        style = _CELL + _RULE
        ink = f"{style}color:{_INK[row.verdict.value]};white-space:nowrap;font-weight:bold"
        told = f'<div style="margin-top:0.3em">{html.escape(row.help)}</div>' if row.help else ""
        return (
            '<tr style="background:transparent">'
            f'<td style="{ink}"><span aria-hidden="true">{row.verdict.sign}</span> '
            f"{row.verdict.value}</td>"
            f'<th scope="row" style="{style}font-weight:normal"><code>{html.escape(row.function)}'
            f'</code></th><td style="{style}">{html.escape(row.asks)}{told}</td></tr>'
        )

    def as_dict(self) -> dict[str, Any]:
        """Return the table as plain data, as ``course check --json`` prints it."""
        rows = [{**asdict(row), "verdict": row.verdict.value} for row in self.rows]
        return {"exercise": self.exercise, "right": self.is_right, "rows": rows}
