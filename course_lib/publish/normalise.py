"""Make an executed notebook's file depend on its content alone.

The same source and the same results give the same bytes, so a diff in version control shows what
changed for a reader and nothing else.
"""

import base64
import hashlib
import struct
from collections.abc import Iterator
from typing import Any

WIDGET_VIEW = "application/vnd.jupyter.widget-view+json"
PNG = "image/png"
_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_PNG_NOTES = {b"tEXt", b"zTXt", b"iTXt", b"tIME", b"eXIf"}


def strip_png_notes(png: bytes) -> bytes:
    """Drop the chunks of a PNG that say who wrote it and when; the pixels stay as they are.

    Parameters
    ----------
    png : bytes
        A PNG file. Anything else is returned unchanged.

    Returns
    -------
    bytes
        The file without text, time and EXIF chunks.
    """
    if not png.startswith(_PNG_SIGNATURE):
        return png
    kept, position = [_PNG_SIGNATURE], len(_PNG_SIGNATURE)
    while position + 12 <= len(png):
        (length,) = struct.unpack(">I", png[position : position + 4])
        end = position + 12 + length
        if png[position + 4 : position + 8] not in _PNG_NOTES:
            kept.append(png[position:end])
        position = end
    return b"".join(kept)


def outputs_of(cell: Any) -> Iterator[Any]:  # noqa: ANN401
    """Yield a cell's outputs; a markdown cell has none."""
    yield from cell.get("outputs", [])


def merge_streams(cell: Any) -> None:  # noqa: ANN401
    """Join what a cell printed in one go, in place: how it arrived in pieces is chance.

    nbclient's own `coalesce_streams` takes time that grows with the square of a line's length.
    """
    merged: list[Any] = []
    for output in outputs_of(cell):
        last = merged[-1] if merged else {}
        if output["output_type"] == "stream" and last.get("name") == output["name"]:
            last["text"] += output["text"]
        else:
            merged.append(output)
    if "outputs" in cell:
        cell["outputs"] = merged


def _normalise_output(output: Any, seed: str) -> None:  # noqa: ANN401
    output.get("metadata", {}).pop("execution", None)
    data = output.get("data", {})
    if PNG in data:
        png = base64.b64decode("".join(data[PNG]))
        data[PNG] = base64.b64encode(strip_png_notes(png)).decode("ascii")
    if WIDGET_VIEW in data:
        # A run draws a new random id. The model is not stored, so any stable name will do.
        data[WIDGET_VIEW]["model_id"] = hashlib.sha256(seed.encode()).hexdigest()[:32]


def normalise(notebook: Any) -> None:  # noqa: ANN401
    """Put an executed notebook into the form in which the repository stores it, in place.

    Parameters
    ----------
    notebook : nbformat.NotebookNode
        Loses ``metadata.widgets``, timings, editor settings and writers' notes in pictures; keeps
        cell ids and tags; widget views get ids that depend on their place alone.
    """
    notebook["metadata"] = type(notebook)(
        {
            "kernelspec": {
                "display_name": "Python 3 (ipykernel)",
                "language": "python",
                "name": "python3",
            },
            "language_info": {"name": "python"},
        }
    )
    notebook["nbformat"], notebook["nbformat_minor"] = 4, 5
    for cell in notebook["cells"]:
        for leftover in ("execution", "trusted", "collapsed", "scrolled", "widgets"):
            cell["metadata"].pop(leftover, None)
        for number, output in enumerate(outputs_of(cell)):
            _normalise_output(output, f"{cell['id']}/{number}")
