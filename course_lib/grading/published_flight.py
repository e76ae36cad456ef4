"""The published flight's frames; which of them a picture shows, and whether drawn on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from rosbags.rosbag1 import Reader

from course_lib import images
from course_lib.grading.drawn import drawn_share

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from course_lib._validate import Image

    Box = tuple[int, int, int, int]

FLIGHT = "flight.bag"
_JPEG_BEGINS = b"\xff\xd8\xff"
_SIZE = (640, 480)
# Frames are told apart by thumbnails of an eighth; of correlations, frames under outlines and
# titles reach more than this, other pictures less.
_THUMBNAIL, _ALIKE = (40, 30), 0.75
_EVERY = 2  # neighbours are nearly the same, and looked at one by one in the end
_ASPECT, _LEAST_WIDTH = 0.1, 100
_BACKGROUND, _PHOTO_ROW = 12, 0.6
_RIM = 0.02  # of a side
_AROUND = 0.25  # of the well's size
_MUCH = 0.3  # of the smaller of two boxes
_LEAST_AREA = 0.03  # of the picture, for one of several in it


@cache
def _recorded() -> list[bytes]:
    with Reader(images.path(FLIGHT)) as reader:
        wanted = [entry for entry in reader.connections if "compressed" in entry.topic]
        raw = [bytes(data) for _, _, data in reader.messages(wanted)]
    return [data[data.index(_JPEG_BEGINS) :] for data in raw]


@cache
def frame(number: int) -> Image:
    """Return a frame of the published flight, BGR uint8, (480, 640, 3); not to be written to."""
    decoded = cv2.imdecode(np.frombuffer(_recorded()[number], np.uint8), cv2.IMREAD_COLOR)
    picture: Image = np.asarray(decoded, np.uint8)
    picture.flags.writeable = False
    return picture


def silhouette(number: int) -> NDArray[np.float64]:
    """Return the well's outline in a frame, (N, 2), (x, y)."""
    record: dict[str, Any] = images.truth(FLIGHT)["frames"][number]["well"]
    return np.array(record["polygon"], np.float64).reshape(-1, 2)


@cache
def _thumbnails() -> tuple[NDArray[np.intp], NDArray[np.float32]]:
    numbers = np.arange(0, len(_recorded()), _EVERY)
    small = [
        cv2.imdecode(np.frombuffer(_recorded()[n], np.uint8), cv2.IMREAD_REDUCED_GRAYSCALE_8)
        for n in numbers
    ]
    return numbers, np.array([_normalised(np.asarray(each, np.uint8)) for each in small])


def _normalised(grey: Image) -> NDArray[np.float32]:
    small = cv2.resize(grey, _THUMBNAIL, interpolation=cv2.INTER_AREA).astype(np.float32).ravel()
    small -= small.mean()
    return np.asarray(small / max(float(np.linalg.norm(small)), 1e-6), np.float32)


@dataclass(frozen=True, order=True)
class Shown:
    """A frame in a picture.

    Attributes
    ----------
    drawn : float
        The share of its pixels that something was drawn on.
    about_well : float
        The share of these that lie at and around the well, as an outline's do and a grid's do not.
    box : (left, top, right, bottom)
        Where, in pixels of the picture.
    """

    drawn: float
    about_well: float
    box: Box


def frames_shown(picture: Image) -> list[Shown]:
    """Find frames of the published flight in a picture.

    Parameters
    ----------
    picture : ndarray of uint8, shape (height, width, 3)
        What was drawn: a frame as it is, a figure with axes, several side by side.

    Returns
    -------
    list of Shown
        The least changed first.
    """
    found = []
    for box in photo_boxes(picture):
        tiles = [(tile, _match(picture, tile)) for tile in _tiles(box)]
        found += [(tile, number) for tile, number in tiles if number is not None]
    # The whole picture may be like a frame, and a frame within a margin even more so.
    shown: list[Shown] = []
    for one in sorted(_shown(picture, box, number) for box, number in found):
        if not any(_overlap(one.box, other.box) for other in shown):
            shown.append(one)
    return shown


def _overlap(box: Box, other: Box) -> bool:
    width = min(box[2], other[2]) - max(box[0], other[0])
    height = min(box[3], other[3]) - max(box[1], other[1])
    smaller = min((b[2] - b[0]) * (b[3] - b[1]) for b in (box, other))
    return width > 0 and height > 0 and width * height > _MUCH * smaller


def _match(picture: Image, box: Box) -> int | None:
    left, top, right, bottom = box
    numbers, known = _thumbnails()
    grey = cv2.cvtColor(np.ascontiguousarray(picture[top:bottom, left:right]), cv2.COLOR_BGR2GRAY)
    scores = known @ _normalised(np.asarray(grey, np.uint8))
    best = int(np.argmax(scores))
    return int(numbers[best]) if scores[best] >= _ALIKE else None


def _shown(picture: Image, box: Box, number: int) -> Shown:
    near = range(max(0, number - _EVERY + 1), min(len(_recorded()), number + _EVERY))
    # The line that matplotlib draws around a picture is not drawn on it.
    left, top, right, bottom = box
    dx, dy = round(_RIM * (right - left)), round(_RIM * (bottom - top))
    inner = (left + dx, top + dy, right - dx, bottom - dy)
    x, y = (round(_RIM * side) for side in _SIZE)
    drawn, best = min((drawn_share(picture, inner, frame(n)[y:-y, x:-x]), n) for n in near)
    return Shown(drawn, _about_well(picture, inner, best, drawn), box)


def _about_well(picture: Image, inner: Box, number: int, drawn: float) -> float:
    outline = silhouette(number)
    if not len(outline) or drawn <= 0:
        return 0.0
    low, high = outline.min(axis=0), outline.max(axis=0)
    margin = _AROUND * (high - low)
    rim = _RIM * np.array(_SIZE)
    corners = np.clip([low - margin, high + margin], rim, np.array(_SIZE) - rim)
    scale = np.array([inner[2] - inner[0], inner[3] - inner[1]]) / (np.array(_SIZE) - 2 * rim)
    (left, top), (right, bottom) = np.rint((corners - rim) * scale + inner[:2]).astype(int)
    (x0, y0), (x1, y1) = np.rint(corners).astype(int)
    if min(right - left, bottom - top, x1 - x0, y1 - y0) < 2:
        return 0.0
    part = (int(left), int(top), int(right), int(bottom))
    there = drawn_share(picture, part, frame(number)[y0:y1, x0:x1])
    of_all = (right - left) * (bottom - top) / ((inner[2] - inner[0]) * (inner[3] - inner[1]))
    return float(min(1.0, there * of_all / drawn))


def photo_boxes(picture: Image) -> list[Box]:
    """Find what may be photographs: the whole picture, or what stands out from its background."""
    height, width = picture.shape[:2]
    boxes: list[Box] = [(0, 0, width, height)]
    background = background_colour(picture)
    stands_out = np.abs(picture.astype(np.int16) - background).max(axis=2) > _BACKGROUND
    count, _, stats, _ = cv2.connectedComponentsWithStats(stands_out.astype(np.uint8))
    for left, top, w, h, _ in stats[1:count]:
        if w * h < _LEAST_AREA * width * height or w < _LEAST_WIDTH:
            continue
        part = stands_out[top : top + h, left : left + w]
        # Ticks stick out of the frame that matplotlib draws around a picture.
        columns = np.nonzero(part.mean(axis=0) > _PHOTO_ROW)[0]
        rows = np.nonzero(part.mean(axis=1) > _PHOTO_ROW)[0]
        if len(columns) and len(rows):
            box = (left + columns[0], top + rows[0], left + columns[-1] + 1, top + rows[-1] + 1)
            boxes.append((int(box[0]), int(box[1]), int(box[2]), int(box[3])))
    return list(dict.fromkeys(boxes))


def background_colour(picture: Image) -> NDArray[np.int16]:
    """Return the most frequent colour, BGR."""
    codes = picture.astype(np.int32) @ np.array([1 << 16, 1 << 8, 1], np.int32)
    values, counts = np.unique(codes[::2, ::2], return_counts=True)
    code = int(values[np.argmax(counts)])
    return np.array([code >> 16, code >> 8 & 255, code & 255], np.int16)


def _tiles(box: Box) -> Iterator[Box]:
    """Yield the box, and its parts where it has the proportions of several frames together."""
    left, top, right, bottom = box
    width, height = right - left, bottom - top
    for rows, columns in ((1, 1), (1, 2), (1, 3), (1, 4), (2, 1), (2, 2), (2, 3), (3, 1)):
        w, h = width / columns, height / rows
        if w < _LEAST_WIDTH or abs(w / h / (_SIZE[0] / _SIZE[1]) - 1) > _ASPECT:
            continue
        for row in range(rows):
            for column in range(columns):
                x, y = left + column * w, top + row * h
                yield round(x), round(y), round(x + w), round(y + h)
