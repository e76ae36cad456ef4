"""The held-out pictures: mug cut-outs and backgrounds, loaded once."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from course_lib import images
from course_lib.scenes.resample import Canvas, opaque, premultiplied

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from course_lib._validate import Image

FOLDER = "heldout"
N_MUGS = 6
N_BACKGROUNDS = 4


class MissingHeldOutError(FileNotFoundError):
    """The held-out pictures are not here: the students' bundle has none, on purpose."""


def record(name: str) -> dict[str, Any]:
    """Return the truth record of a held-out picture."""
    try:
        return images.truth(f"{FOLDER}/{name}")
    except images.MissingImageError as error:
        raise _missing(name) from error


def picture(name: str, *, alpha: bool = False) -> Image:
    """
    Load a held-out picture.

    Raises
    ------
    MissingHeldOutError
        It is not there.
    """
    try:
        return images.load(f"{FOLDER}/{name}", alpha=alpha)
    except images.MissingImageError as error:
        raise _missing(name) from error


def flight_path(name: str) -> str:
    """
    Return the path of a held-out flight.

    Raises
    ------
    MissingHeldOutError
        It is not there.
    """
    try:
        return str(images.path(f"{FOLDER}/{name}"))
    except images.MissingImageError as error:
        raise _missing(name) from error


def _missing(name: str) -> MissingHeldOutError:
    return MissingHeldOutError(
        f"No {FOLDER}/{name} among the course's images. Held-out scenes are made from it, for "
        "grading only; it comes with the course's repository and not with the students' bundle."
    )


@cache
def mug_cut_out(number: int) -> Image:
    """Return mug ``number`` (from 0) as premultiplied BGRA; nobody may write to it."""
    cut_out = premultiplied(picture(f"mug_{number + 1}.png", alpha=True))
    cut_out.flags.writeable = False
    return cut_out


@cache
def mug_canvas(number: int) -> Canvas:
    """Return mug ``number`` ready to be warped."""
    return Canvas(mug_cut_out(number))


@cache
def mug_box(number: int) -> tuple[int, int, int, int]:
    """Return left, top, right, bottom (outside) of the visible part of mug ``number``."""
    rows, columns = np.nonzero(mug_cut_out(number)[..., 3] > 127)
    return int(columns.min()), int(rows.min()), int(columns.max()) + 1, int(rows.max()) + 1


@cache
def print_places(number: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the print's corners on mug ``number``, TL, BL, BR, TR, and points all over it."""
    mug = record(f"mug_{number + 1}.png")["objects"]["mug"]
    grid = np.array(mug["print_grid"], np.float64).reshape(-1, 2)
    return np.array(mug["print_corners"], np.float64), grid


@cache
def background(number: int) -> Image:
    """Return background ``number`` (from 0); nobody may write to it."""
    loaded = picture(f"background_{number + 1}.jpg")
    loaded.flags.writeable = False
    return loaded


@cache
def background_canvas(number: int) -> Canvas:
    """Return background ``number`` ready to be warped."""
    return Canvas(opaque(background(number)))
