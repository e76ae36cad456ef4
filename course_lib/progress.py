"""A progress bar for notebooks: one small picture, replaced as the work goes on.

No widget is involved, so it can neither stall a run without a browser nor die with its kernel, and
what a notebook stores of it is the full bar.
"""

from __future__ import annotations

import base64
import io
import sys
import time
from typing import TYPE_CHECKING, Any, TypeVar

import matplotlib as mpl
import PIL.Image
import PIL.ImageDraw
import PIL.ImageFont

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

T = TypeVar("T")

FEW = 10  # fewer things need no bar
SECONDS = 0.2  # between two pictures; more often, the eye gains nothing
WIDTH, HEIGHT, TEXT = 420, 24, 180


def track(things: Sequence[T], label: str = "steps") -> Iterator[T]:
    """
    Go through things and show, below a notebook's cell, how many are done.

    Parameters
    ----------
    things : sequence
    label : str
        What they are, in the plural: ``"frames"``.

    Yields
    ------
    object
        One thing after the other. Outside a notebook, and for a few things, nothing is shown.

    Examples
    --------
    >>> [number**2 for number in track(range(3), "numbers")]
    [0, 1, 4]
    """
    shown = _Bar(len(things), label) if len(things) >= FEW and _in_notebook() else None
    for done, thing in enumerate(things, start=1):
        yield thing
        if shown:
            shown.show(done)


def _in_notebook() -> bool:
    # IPython is not imported for this: where it runs, it has been.
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return hasattr(shell, "kernel")


class _Bar:
    def __init__(self, total: int, label: str) -> None:
        from IPython.display import display  # noqa: PLC0415 (not needed outside a notebook)

        self._total, self._label = total, label
        self._begun = self._shown = time.monotonic()
        data, about = self._content(0)
        self._handle: Any = display(data, metadata=about, raw=True, display_id=True)  # type: ignore[no-untyped-call]

    def show(self, done: int) -> None:
        now = time.monotonic()
        if done < self._total and now - self._shown < SECONDS:
            return
        self._shown = now
        data, about = self._content(done)
        self._handle.update(data, metadata=about, raw=True)

    def _content(self, done: int) -> tuple[dict[str, str], dict[str, Any]]:
        text = f"{done} of {self._total} {self._label}"
        elapsed = self._shown - self._begun
        if 0 < done < self._total and elapsed > 1:
            text += f", {elapsed / done * (self._total - done):.0f} s left"
        png = base64.b64encode(bar_png(done / max(self._total, 1), text)).decode("ascii")
        # The plain text is the same from beginning to end, as nbval compares the beginning of a new
        # run with the stored end.
        plain = f"{self._total} {self._label}"
        return {"image/png": png, "text/plain": plain}, {"image/png": {"alt": text, "width": WIDTH}}


def bar_png(share: float, text: str) -> bytes:
    """
    Draw a progress bar.

    Parameters
    ----------
    share : float
        From 0 to 1.
    text : str
        What stands beside it.

    Returns
    -------
    bytes
        A PNG, `WIDTH` × `HEIGHT` pixels.
    """
    picture = PIL.Image.new("P", (WIDTH, HEIGHT), 0)
    picture.putpalette([255, 255, 255, 150, 150, 150, 0, 158, 115, 0, 0, 0])
    draw = PIL.ImageDraw.Draw(picture)
    draw.fontmode = "1"  # a palette has no shades for soft edges
    box = (0, 4, WIDTH - TEXT - 10, HEIGHT - 5)
    draw.rectangle(box, outline=1)
    if share > 0:
        draw.rectangle((2, 6, 2 + (box[2] - 4) * min(share, 1.0), HEIGHT - 7), fill=2)
    font = PIL.ImageFont.truetype(f"{mpl.get_data_path()}/fonts/ttf/DejaVuSans.ttf", 13)
    draw.text((WIDTH - TEXT, 4), text, fill=3, font=font)
    buffer = io.BytesIO()
    picture.save(buffer, "PNG")
    return buffer.getvalue()
