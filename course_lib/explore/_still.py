"""Still pictures that stand in for a viewer where no browser widget can run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib import font_manager
from PIL import Image, ImageDraw, ImageFont

if TYPE_CHECKING:
    from numpy.typing import NDArray


def caption(image: NDArray[np.uint8], text: str) -> NDArray[np.uint8]:
    """Put a line of text under a BGR picture, wrapped to its width."""
    page = text_page(text, image.shape[1], size=15)
    return np.vstack([image, page])


def text_page(text: str, width: int, *, size: int = 16, margin: int = 10) -> NDArray[np.uint8]:
    """Typeset text on white, BGR uint8 of the given width; line breaks in `text` are kept."""
    font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), size)
    lines = [line for part in text.split("\n") for line in _wrap(part, font, width - 2 * margin)]
    step = round(1.45 * size)
    page = Image.new("RGB", (width, step * len(lines) + 2 * margin), "white")
    pen = ImageDraw.Draw(page)
    for row, line in enumerate(lines):
        pen.text((margin, margin + row * step), line, fill="#1f2933", font=font)
    return np.ascontiguousarray(np.asarray(page)[..., ::-1])


def _wrap(text: str, font: ImageFont.FreeTypeFont, width: int) -> list[str]:
    lines = [""]
    for word in text.split(" "):
        longer = f"{lines[-1]} {word}" if lines[-1] else word
        if lines[-1] and font.getlength(longer) > width:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines
