"""What all viewers share: a canvas drawn in the browser, and a box that also carries a still."""

from __future__ import annotations

import base64
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anywidget
import cv2
import ipywidgets
import numpy as np
from traitlets import Bytes, Int, List, Unicode

from course_lib.display import encode_png

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

STATIC = Path(__file__).parent / "static"
# Stored notebooks stay small enough to read on the web.
STILL_BYTES = 100_000


@cache
def module(name: str) -> str:
    """Return the JavaScript module of a viewer, the shared helpers in front of its own code.

    A widget's module reaches the browser as one text and cannot import a neighbour by its path,
    so the two files are joined here.
    """
    return "\n".join((STATIC / f"{part}.js").read_text(encoding="utf-8") for part in ("base", name))


@cache
def stylesheet() -> str:
    """Return the style sheet that all viewers share."""
    return (STATIC / "base.css").read_text(encoding="utf-8")


class Canvas(anywidget.AnyWidget):
    """A picture that the browser draws; viewers add their data as further traits.

    Attributes
    ----------
    picture
        Background picture, an encoded JPEG or PNG file.
    width, height
        Size of the canvas on the page, in CSS pixels; it never changes, so the page never jumps.
    alt
        Text alternative.
    quiet
        Identifiers of the widgets that tell the kernel their values when they come to rest, not at
        each step of a drag; `link` adds to it.
    """

    _css = stylesheet()

    picture = Bytes().tag(sync=True)
    width = Int().tag(sync=True)
    height = Int().tag(sync=True)
    alt = Unicode().tag(sync=True)
    quiet = List(Unicode()).tag(sync=True)


class Viewer(ipywidgets.VBox):  # type: ignore[misc]  # ipywidgets has no types
    """Controls and canvas, with a still picture and alt text for readers without a kernel.

    Parameters
    ----------
    children
        Controls first, then the canvas.
    still
        What the viewer shows at first, BGR uint8 of shape (height, width, 3).
    alt
        Text alternative of the still picture; also the viewer's `text/plain`.
    """

    def __init__(
        self, children: Sequence[ipywidgets.Widget], *, still: NDArray[np.uint8], alt: str
    ) -> None:
        super().__init__(list(children))
        self.add_class("fm-box")
        self.alt = alt
        self._png = encode_png(still, max_bytes=STILL_BYTES)

    def __repr__(self) -> str:
        return self.alt

    def _repr_mimebundle_(self, **kwargs: object) -> tuple[dict[str, Any], dict[str, Any]]:
        return mimebundle(super()._repr_mimebundle_(**kwargs), self._png, self.alt)


def mimebundle(
    bundle: dict[str, Any] | tuple[dict[str, Any], dict[str, Any]] | None, still: bytes, alt: str
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Add a still picture and its text alternative to a widget's mime bundle."""
    data, metadata = bundle if isinstance(bundle, tuple) else (bundle or {}, {})
    return (
        {**data, "image/png": base64.b64encode(still).decode("ascii"), "text/plain": alt},
        {**metadata, "image/png": {"alt": alt}},
    )


def colour_picture(image: NDArray[np.uint8], name: str = "image") -> NDArray[np.uint8]:
    """Return `image` as contiguous BGR, whether it came grey, BGR or BGRA.

    Raises
    ------
    TypeError
        When it is no uint8 array.
    ValueError
        When it is empty or has another shape.
    """
    if not isinstance(image, np.ndarray) or image.dtype != np.uint8:
        kind = getattr(image, "dtype", type(image).__name__)
        raise TypeError(
            f"{name} must be a uint8 array of grey values or BGR pixels, not {kind}; "
            "cv2.imread and course_lib.images.load give one (cv2.imread gives None for a file "
            "that is not there)"
        )
    channels = 1 if image.ndim == 2 else image.shape[-1]
    if image.ndim not in {2, 3} or channels not in {1, 3, 4} or image.size == 0:
        raise ValueError(
            f"{name} must have shape (height, width), (height, width, 3) or (height, width, 4), "
            f"not {image.shape}"
        )
    image = np.ascontiguousarray(image)
    if channels == 1:
        return np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), np.uint8)
    if channels == 4:
        return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGRA2BGR), np.uint8)
    return image


def jpeg(image: NDArray[np.uint8], quality: int = 88) -> bytes:
    """Encode a BGR picture as a JPEG file for the browser."""
    return bytes(cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])[1])


def link(
    control: ipywidgets.Widget, canvas: Canvas, trait: str, *, attribute: str = "value"
) -> None:
    """Link a control's value to a canvas trait inside the browser, in both directions.

    The kernel is told when they come to rest: a message at each step of a drag, with the kernel's
    replies, costs the browser more than half of its pictures.
    """
    ipywidgets.jslink((control, attribute), (canvas, trait))
    quieten(canvas, control)


def quieten(canvas: Canvas, *controls: ipywidgets.Widget) -> None:
    """Let a canvas and its controls tell the kernel their values only when they rest."""
    ids = [widget.model_id for widget in (canvas, *controls)]
    canvas.quiet = list(dict.fromkeys([*canvas.quiet, *ids]))


def slider(description: str, value: float, low: float, high: float, step: float = 1) -> Any:  # noqa: ANN401
    """Make a slider as wide as its viewers' canvases, with a label that is never cut off."""
    kind = ipywidgets.IntSlider if isinstance(step, int) else ipywidgets.FloatSlider
    return kind(
        value=value,
        min=low,
        max=high,
        step=step,
        description=description,
        style={"description_width": "initial"},
        layout={"width": "min(100%, 540px)"},
    )
