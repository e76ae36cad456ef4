"""Show pictures in a notebook: small PNG outputs that carry their text alternative."""

from __future__ import annotations

import base64
import io
import math
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
import PIL.Image
import PIL.ImageDraw
import PIL.ImageFont

from course_lib._validate import Image, as_bgr, as_count

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

MAX_BYTES = 140_000
# A notebook's column is about this wide; more pixels only weigh.
MAX_WIDTH = 1200
MIN_WIDTH = 64
GAP = 12
# Half as many colours make a picture about this much smaller, seldom less.
_HALVED = 0.75
# A palette found in a hundredth of the time is good for a guess: the better one makes so much more.
_FINER = 1.3
_PLAIN = PIL.Image.Dither.NONE
CAPTION_SIZE = 15


def show(
    image: Image | Sequence[Image],
    *,
    alt: str,
    title: str | None = None,
    captions: Sequence[str] | None = None,
    columns: int | None = None,
    width: int | None = None,
    max_bytes: int = MAX_BYTES,
) -> None:
    """
    Display a picture, or several side by side, as one PNG output of a notebook cell.

    Parameters
    ----------
    image : ndarray, or sequence of ndarray
        BGR uint8 (H, W, 3), or what :func:`course_lib._validate.as_image` accepts.
    alt : str
        What the picture shows, for readers who cannot see it.
    title : str or None
        A line above the picture.
    captions : sequence of str or None
        A line above each of several pictures.
    columns : int or None
        Pictures in a row; None puts all in one.
    width : int or None
        Shrink the output to at most this many pixels of width; None keeps up to 1200.
    max_bytes : int
        Use fewer colours, then fewer pixels, until the PNG is no larger than this.

    Raises
    ------
    TypeError, ValueError
        No alt text, not pictures, or not one caption for each picture.
    """
    pictures = [image] if isinstance(image, np.ndarray) else list(image)
    if not pictures:
        raise ValueError("image is an empty sequence: nothing to show")
    if captions is not None and len(captions) != len(pictures):
        raise ValueError(f"{len(pictures)} pictures need as many captions, got {len(captions)}")
    limit = MAX_WIDTH if width is None else as_count(width, "width", 1)
    sheet = _sheet(pictures, captions, as_count(columns or len(pictures), "columns", 1), limit)
    if title:
        sheet = _headed(sheet, title)
    _publish(encode_png(sheet, max_bytes=max_bytes), sheet.width, alt)


def plot(fig: Figure, *, alt: str, dpi: int = 100, max_bytes: int = MAX_BYTES) -> None:
    """
    Display a matplotlib figure as a PNG output and close it.

    Parameters
    ----------
    fig : matplotlib.figure.Figure
    alt : str
        What the plot shows, for readers who cannot see it.
    dpi : int
        Pixels per inch of the figure's size.
    max_bytes : int
        See :func:`show`.
    """
    import matplotlib.pyplot as plt  # noqa: PLC0415 (slow, and only needed here)

    buffer = io.BytesIO()
    fig.savefig(buffer, format="png", dpi=dpi, bbox_inches="tight", facecolor="white")
    plt.close(fig)
    drawn = PIL.Image.open(buffer).convert("RGB")
    _publish(encode_png(drawn, max_bytes=max_bytes), drawn.width, alt)


def encode_png(
    picture: Image | PIL.Image.Image, *, max_width: int | None = None, max_bytes: int = MAX_BYTES
) -> bytes:
    """
    Encode a picture as a PNG of limited size.

    A notebook keeps its outputs, so a photograph in full colour would weigh half a megabyte each.
    A palette of its own 256 colours, or fewer, is hardly seen; pixels are given up last.

    Parameters
    ----------
    picture : ndarray or PIL.Image.Image
        BGR uint8 array, or a PIL picture.
    max_width : int or None
        Shrink to at most this width first.
    max_bytes : int
        The limit; a picture is not made narrower than 64 pixels for it.

    Returns
    -------
    bytes
    """
    sheet = _as_pil(picture) if isinstance(picture, np.ndarray) else picture.convert("RGB")
    if max_width is not None:
        sheet = _narrowed(sheet, as_count(max_width, "max_width", 1))
    rough = len(_png(sheet.quantize(256, PIL.Image.Quantize.FASTOCTREE, dither=_PLAIN)))
    if rough <= max_bytes:
        data = _png(sheet)
        if len(data) <= max_bytes:
            return data
    elif rough * _FINER > max_bytes / _HALVED:
        sheet = _fitted(sheet, max_bytes / (rough * _FINER))
    while True:
        for colours in (256, 128):
            data = _png(sheet.quantize(colours, dither=_PLAIN))
            if len(data) <= max_bytes:
                return data
            if len(data) > max_bytes / _HALVED:
                break
        if sheet.width <= MIN_WIDTH:
            return data
        sheet = _fitted(sheet, max_bytes / len(data))


def _png(sheet: PIL.Image.Image) -> bytes:
    buffer = io.BytesIO()
    sheet.save(buffer, "PNG")
    return buffer.getvalue()


def _fitted(sheet: PIL.Image.Image, part: float) -> PIL.Image.Image:
    """Shrink to a part of the bytes: they go with the area. A little less, so that it suffices."""
    return _narrowed(sheet, max(MIN_WIDTH, int(sheet.width * 0.97 * math.sqrt(part))))


def _publish(png: bytes, width: int, alt: str) -> None:
    if not isinstance(alt, str) or not alt.strip():
        raise ValueError("alt must say in words what the picture shows")
    from IPython.display import display  # noqa: PLC0415 (not needed by library users)

    # Raw publishing keeps text/plain the alt text, where display(Image) would print an address.
    display(  # type: ignore[no-untyped-call]
        {"image/png": base64.b64encode(png).decode("ascii"), "text/plain": alt},
        metadata={"image/png": {"alt": alt, "width": width}},
        raw=True,
    )


def _as_pil(image: Image) -> PIL.Image.Image:
    return PIL.Image.fromarray(as_bgr(image, "image")[:, :, ::-1])


def _narrowed(sheet: PIL.Image.Image, width: int) -> PIL.Image.Image:
    if sheet.width <= width:
        return sheet
    size = (width, max(1, round(sheet.height * width / sheet.width)))
    return sheet.resize(size, PIL.Image.Resampling.LANCZOS)


def _sheet(
    pictures: Sequence[Image], captions: Sequence[str] | None, columns: int, limit: int
) -> PIL.Image.Image:
    """Put pictures in rows, at most `limit` pixels wide, and captions of full size above them."""
    parts = [_as_pil(picture) for picture in pictures]
    widest = max(
        sum(p.width for p in parts[i : i + columns]) for i in range(0, len(parts), columns)
    )
    room = max(1, limit - GAP * (min(columns, len(parts)) - 1))
    if widest > room:
        parts = [_narrowed(part, max(1, part.width * room // widest)) for part in parts]
    if captions is not None:
        parts = [_headed(part, text) for part, text in zip(parts, captions, strict=True)]
    rows = [_row(parts[i : i + columns]) for i in range(0, len(parts), columns)]
    sheet = PIL.Image.new(
        "RGB",
        (max(row.width for row in rows), sum(row.height for row in rows) + GAP * (len(rows) - 1)),
        "white",
    )
    top = 0
    for row in rows:
        sheet.paste(row, (0, top))
        top += row.height + GAP
    return sheet


def _row(parts: Sequence[PIL.Image.Image]) -> PIL.Image.Image:
    width = sum(part.width for part in parts) + GAP * (len(parts) - 1)
    row = PIL.Image.new("RGB", (width, max(part.height for part in parts)), "white")
    left = 0
    for part in parts:
        row.paste(part, (left, 0))
        left += part.width + GAP
    return row


def _headed(sheet: PIL.Image.Image, text: str) -> PIL.Image.Image:
    font = PIL.ImageFont.truetype(f"{mpl.get_data_path()}/fonts/ttf/DejaVuSans.ttf", CAPTION_SIZE)
    room = CAPTION_SIZE * 2
    headed = PIL.Image.new("RGB", (sheet.width, sheet.height + room), "white")
    headed.paste(sheet, (0, room))
    PIL.ImageDraw.Draw(headed).text((2, CAPTION_SIZE * 0.4), text, fill="black", font=font)
    return headed
