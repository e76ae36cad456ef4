"""The flight viewer: a recorded flight frame by frame, with the outline for every match count."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, Protocol

import cv2
import ipywidgets
import numpy as np
from traitlets import Bytes, Int, Unicode

from course_lib.explore._base import (
    Canvas,
    Viewer,
    colour_picture,
    jpeg,
    link,
    module,
    quieten,
    slider,
)
from course_lib.explore._estimate import Estimate, Pairer, estimate
from course_lib.explore._still import caption
from course_lib.homography import project

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

FRAME_WIDTH = 480
STRIP = 110  # CSS pixels of the plot under the frame
COUNTS = (4, 12, 22, 40, 58, 100, 150, 1000)
IN_VIEW = 0.9
FOUND_BGR, ABSURD_BGR = (94, 197, 34), (68, 68, 239)
FAR = 30_000.0


class TimedFrame(Protocol):
    """What the viewer reads of `course_lib.camera.Frame`."""

    @property
    def image(self) -> NDArray[np.uint8]:
        """BGR uint8 of shape (height, width, 3)."""

    @property
    def truth(self) -> Mapping[str, Any] | None:
        """The renderer's record of the frame."""


class FlightCanvas(Canvas):
    """Frames of a flight; an outline for every frame and match count."""

    _esm = module("flight")

    position = Int().tag(sync=True)
    count = Int().tag(sync=True)
    frames = Bytes().tag(sync=True)
    outlines = Bytes().tag(sync=True)
    inliers = Bytes().tag(sync=True)
    errors = Bytes().tag(sync=True)
    about = Unicode().tag(sync=True)


def flight(
    frames: Sequence[TimedFrame],
    template: NDArray[np.uint8],
    *,
    outline: ArrayLike | None = None,
    counts: Sequence[int] = COUNTS,
    match_count: int = 100,
    every: int = 5,
    ransac_threshold: float = 5.0,
    alt: str | None = None,
) -> Viewer:
    """Move along a flight and change how many matches are used.

    Every `every`-th frame is matched once; RANSAC then runs for every match count. Under the
    frame, a strip shows for the whole flight where the object was found, with how many inliers
    and how far off.

    Parameters
    ----------
    frames
        Frames with a BGR `image`, and a `truth` with the object's `polygon` and `visible` share
        under "well" where the error is wanted.
    template
        The object, BGR uint8 of shape (height, width, 3).
    outline
        The object's silhouette in template pixels, shape (N, 2); with it the error is the
        distance between the middles of the found and the true silhouette.
    counts
        Match counts to choose from, ascending.
    match_count
        The count shown first; the nearest of `counts` is taken.
    every
        Use every n-th frame.
    ransac_threshold
        In scene pixels.
    alt
        Text alternative of the viewer.

    Returns
    -------
    Viewer
        Play button, sliders for position and match count, and the canvas.

    Raises
    ------
    TypeError, ValueError
        When a picture is no picture, or there is no frame.
    """
    chosen = list(frames)[::every]
    if not chosen:
        raise ValueError("frames is empty: nothing to fly along")
    pairer = Pairer(colour_picture(template, "template"))
    pairings = [pairer.pair(colour_picture(f.image, "frames")) for f in chosen]
    with ThreadPoolExecutor() as pool:  # OpenCV lets go of the interpreter, and draws no luck
        table = list(
            pool.map(lambda p: [estimate(p, n, ransac_threshold) for n in counts], pairings)
        )
    silhouette = None if outline is None else np.asarray(outline, np.float64).reshape(-1, 2)
    errors = np.array(
        [[_error(e, f, silhouette) for e in row] for row, f in zip(table, chosen, strict=True)],
        np.float32,
    )
    at = int(np.argmin([abs(n - match_count) for n in counts]))
    in_view = [float(_well(f).get("visible", 1.0)) for f in chosen]
    found = sum(not row[at].fault for row in table)
    height, width = chosen[0].image.shape[:2]
    alt = alt or (
        f"A flight of {len(chosen)} frames with sliders for position and match count. With "
        f"{counts[at]} matches the object is outlined in {found} frames."
    )
    shrunk = [_shrunk(f.image) for f in chosen]
    canvas = _canvas(shrunk, table, errors, (width, height), at, alt)
    canvas.about = json.dumps(
        {
            "counts": list(counts),
            "every": every,
            "scale": FRAME_WIDTH / width,
            "frame": [FRAME_WIDTH, round(height * FRAME_WIDTH / width)],
            "strip": STRIP,
            "offsets": [0, *np.cumsum([len(data) for data in shrunk]).tolist()],
            "faults": [[e.fault for e in row] for row in table],
            "inView": in_view,
            "judged": silhouette is not None,
        }
    )
    label = f"{alt} Run the notebook to fly."
    still = caption(_draw(chosen[len(chosen) // 3].image, table[len(chosen) // 3][at]), label)
    return Viewer([*_controls(canvas, len(chosen), counts, at), canvas], still=still, alt=alt)


def _shrunk(image: NDArray[np.uint8]) -> bytes:
    height = round(image.shape[0] * FRAME_WIDTH / image.shape[1])
    small = cv2.resize(image, (FRAME_WIDTH, height), interpolation=cv2.INTER_AREA)
    return jpeg(np.asarray(small, np.uint8), quality=75)


def _canvas(
    shrunk: Sequence[bytes],
    table: Sequence[Sequence[Estimate]],
    errors: NDArray[np.float32],
    size: tuple[int, int],
    at: int,
    alt: str,
) -> FlightCanvas:
    outlines = np.full((len(table), len(table[0]), 8), np.nan, np.float32)
    for i, row in enumerate(table):
        for j, result in enumerate(row):
            if result.corners is not None:
                outlines[i, j] = np.clip(result.corners, -FAR, FAR).ravel()
    return FlightCanvas(
        picture=shrunk[0],
        width=FRAME_WIDTH,
        height=round(size[1] * FRAME_WIDTH / size[0]) + STRIP,
        position=0,
        count=at,
        frames=b"".join(shrunk),
        outlines=outlines.astype("<f4").tobytes(),
        inliers=np.array([[e.inliers.sum() for e in row] for row in table], "<u2").tobytes(),
        errors=errors.astype("<f4").tobytes(),
        alt=alt,
    )


def _controls(
    canvas: FlightCanvas, length: int, counts: Sequence[int], at: int
) -> list[ipywidgets.Widget]:
    position = slider("frame", 0, 0, length - 1)
    play = ipywidgets.Play(value=0, min=0, max=length - 1, interval=150)
    ipywidgets.jslink((play, "value"), (position, "value"))
    link(position, canvas, "position")
    quieten(canvas, play)
    labels = [str(n) if n < 1000 else "all" for n in counts]
    count = ipywidgets.SelectionSlider(
        options=labels,
        index=at,
        description="matches used",
        style={"description_width": "initial"},
        layout={"width": "min(100%, 540px)"},
    )
    link(count, canvas, "count", attribute="index")
    return [ipywidgets.HBox([play, position]), count]


def _well(frame: TimedFrame) -> Mapping[str, Any]:
    well: Mapping[str, Any] = (frame.truth or {}).get("well", {})
    return well


def _middle(polygon: NDArray[np.float64]) -> NDArray[np.float64]:
    moments = cv2.moments(np.asarray(polygon, np.float32))
    if not moments["m00"]:
        return np.full(2, np.nan)
    return np.array([moments["m10"], moments["m01"]]) / moments["m00"]


def _error(result: Estimate, frame: TimedFrame, outline: NDArray[np.float64] | None) -> float:
    well = _well(frame)
    if result.fault or result.H is None or outline is None or well.get("visible", 0) < IN_VIEW:
        return float("nan")
    moved = _middle(project(result.H, outline))
    return float(np.linalg.norm(moved - _middle(np.asarray(well["polygon"], np.float64))))


def _draw(image: NDArray[np.uint8], result: Estimate) -> NDArray[np.uint8]:
    still = image.copy()
    if result.corners is not None:
        outline = np.rint(np.clip(result.corners, -FAR, FAR)).astype(np.int32)
        ink = ABSURD_BGR if result.fault else FOUND_BGR
        cv2.polylines(still, [outline], True, ink, 3, cv2.LINE_AA)  # noqa: FBT003
    return still
