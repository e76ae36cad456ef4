"""Shows how far grading is: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from contextlib import suppress
from typing import TYPE_CHECKING, Protocol

from rich.console import Console
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from course_lib.grading.summary import checked, line, points

if TYPE_CHECKING:
    from rich.console import RenderableType

    from course_lib.grading.messages import Finished
    from course_lib.grading.runner import Outcome

_MOST_NAMES = 4


class Progress(Protocol):
    """What a run tells of itself."""

    def start(self, total: int, outcome: Outcome) -> None:
        """Tell that so many submissions are to be graded."""

    def started(self, student: str) -> None:
        """Tell that one has begun."""

    def finished(self, event: Finished) -> None:
        """Tell that one has ended."""

    def stop(self) -> None:
        """Tell that no more will come."""


class _Console(Console):
    """Goes quiet when nobody reads it any more, where rich would end the program."""

    def on_broken_pipe(self) -> None:
        self.quiet = True


class Shown:
    """Shows progress to people.

    Parameters
    ----------
    console : Console, optional
        By default standard error.
    verbose : bool, optional
        Whether points are shown too.
    """

    def __init__(self, console: Console | None = None, *, verbose: bool = False) -> None:
        self._console = console or _Console(stderr=True, highlight=False)
        self._verbose = verbose
        self._live: Live | None = None
        self._running: dict[str, float] = {}
        self._total = self._done = 0
        self._begun = time.monotonic()

    def start(self, total: int, outcome: Outcome) -> None:
        """Begin."""
        self._total, self._begun = total, time.monotonic()
        if outcome.unchanged:
            self._say(f"{len(outcome.unchanged)} unchanged, not graded again")
        if total and self._console.is_terminal:
            self._live = Live(
                get_renderable=self._bar,
                console=self._console,
                refresh_per_second=4,
                transient=True,
            )
            self._live.start()

    def started(self, student: str) -> None:
        """Show a name."""
        self._running[student] = time.monotonic()

    def finished(self, event: Finished) -> None:
        """Count, and say what should not be missed."""
        result = event.result
        began = self._running.pop(result.student, time.monotonic())
        self._done += 1
        parts = [f"{self._done:>{len(str(self._total))}}/{self._total}", line(result.student, 60)]
        parts.append(f"{time.monotonic() - began:.1f} s")
        if self._verbose:
            parts.append(f"{points(result.score)} of {points(result.max_score)} points")
        unchecked = checked(result.tests)
        if unchecked != "graded":
            parts.append(f"{unchecked}: {line(event.failure or ', '.join(result.events), 200)}")
        elif self._verbose and result.events:
            parts.append(line("; ".join(result.events), 200))
        if self._live is None and self._left():
            parts.append(self._left())
        if self._live is None or self._verbose or unchecked != "graded":
            self._say("  ".join(parts))

    def stop(self) -> None:
        """Take the bar away."""
        if self._live:
            with suppress(OSError):  # the terminal may be gone
                self._live.stop()
            self._live = None

    def _say(self, text: str) -> None:
        with suppress(OSError):  # a full disk or a lost terminal costs the line, not the run
            self._console.print(text, markup=False, soft_wrap=True)

    def _left(self) -> str:
        if not self._done or self._done >= self._total:
            return ""
        return "about " + for_people(self._estimate()) + " left"

    def _estimate(self) -> float:
        """Estimate the seconds left from the submissions so far."""
        elapsed = time.monotonic() - self._begun
        return elapsed / self._done * (self._total - self._done)

    def _bar(self) -> RenderableType:
        row = Table.grid(padding=(0, 2))
        names = [line(name, 30) for name in self._running]
        more = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
        row.add_row(
            ProgressBar(total=max(1, self._total), completed=self._done, width=24),
            Text(f"{self._done}/{self._total}"),
            Text(self._left() or for_people(time.monotonic() - self._begun)),
            Text(", ".join(names[:_MOST_NAMES]) + more, no_wrap=True, overflow="ellipsis"),
        )
        return row


def for_people(seconds: float) -> str:
    """Write a time as people say it.

    Examples
    --------
    >>> for_people(8.2), for_people(130), for_people(9000)
    ('9 s', '3 min', '2 h 30 min')
    """
    if seconds < 90:
        return f"{int(seconds) + 1} s"
    minutes = int(seconds // 60) + 1 if seconds % 60 else int(seconds // 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"
