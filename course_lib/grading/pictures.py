"""Pictures that a stranger's process sends: decoded, or left out if they are no ordinary ones."""

from __future__ import annotations

import base64
import binascii
import io
import re
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, UnidentifiedImageError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

_MOST_PIXELS = 16_000_000
_MOST_BASE64 = 12_000_000
_WITHIN_TEXT = re.compile(r"data:image/(?:png|jpe?g);base64,([A-Za-z0-9+/=]++)")


def pictures_of(data: Mapping[str, Any]) -> Iterator[NDArray[np.uint8]]:
    """Give the pictures of an output: those that it is, and those within its HTML or markdown.

    Parameters
    ----------
    data : mapping
        MIME types and contents.

    Yields
    ------
    ndarray
        BGR uint8.
    """
    for encoded in _encoded(data):
        yield from _decoded(encoded)


def _encoded(data: Mapping[str, Any]) -> Iterator[str]:
    for kind in ("image/png", "image/jpeg"):
        if isinstance(data.get(kind), str):
            yield data[kind]
    for kind in ("text/html", "text/markdown"):
        if isinstance(data.get(kind), str):
            yield from (match[1] for match in _WITHIN_TEXT.finditer(data[kind]))


def _decoded(encoded: str) -> list[NDArray[np.uint8]]:
    if len(encoded) > _MOST_BASE64:
        return []
    try:
        return picture_in(base64.b64decode(encoded))
    except (ValueError, binascii.Error):
        return []


def picture_in(data: bytes) -> list[NDArray[np.uint8]]:
    """Decode a picture file that a stranger made: one, or none if it is no ordinary picture.

    Parameters
    ----------
    data : bytes
        A PNG, JPEG or BMP file.

    Returns
    -------
    list of ndarray
        BGR uint8, at most one.
    """
    try:
        with Image.open(io.BytesIO(data), formats=("PNG", "JPEG", "BMP")) as picture:
            if picture.width * picture.height > _MOST_PIXELS:
                return []
            rgb = np.asarray(picture.convert("RGBA").convert("RGB"), np.uint8)
    except (OSError, ValueError, SyntaxError, UnidentifiedImageError):
        return []
    except Image.DecompressionBombError:
        return []
    return [np.ascontiguousarray(rgb[..., ::-1])]
