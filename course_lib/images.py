"""The course's pictures, by name, with the exact truth that the renderer recorded."""

from __future__ import annotations

import difflib
import json
import os
from pathlib import Path, PurePosixPath
from typing import Any

import cv2
import numpy as np

from course_lib._validate import MAX_SIDE, Image, as_count, as_image

PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg")
FOLDER_VARIABLE = "COURSE_IMAGES"


class MissingImageError(FileNotFoundError):
    """No file of that name among the course's images."""


class UnreadableImageError(OSError):
    """The file exists, but is not what its name says."""


def folder() -> Path:
    """
    Return the folder that holds the course's images.

    It is ``images/`` beside the package (the course is installed in place), or whatever the
    environment variable ``COURSE_IMAGES`` names.

    Raises
    ------
    MissingImageError
        There is no such folder.
    """
    chosen = os.environ.get(FOLDER_VARIABLE)
    place = Path(chosen) if chosen else Path(__file__).resolve().parents[1] / "images"
    if not place.is_dir():
        cause = (
            f"{FOLDER_VARIABLE} names it: correct or unset that variable"
            if chosen
            else "the course is installed away from its repository: install it with "
            f"`pip install -e .` there, or point {FOLDER_VARIABLE} at the images"
        )
        raise MissingImageError(f"No folder {place}. {cause}.")
    return place


def names(subfolder: str = "") -> list[str]:
    """
    List the pictures that :func:`load` can load, sorted.

    Parameters
    ----------
    subfolder : str
        List another folder inside the images instead, such as ``"heldout"``.

    Returns
    -------
    list of str
        Names as :func:`load` takes them: ``"box.png"``, ``"heldout/mug_1.png"``.
    """
    root = folder()
    place = root / subfolder
    if not place.is_dir():
        raise MissingImageError(f"No folder {subfolder!r} in {root}.")
    return sorted(
        entry.relative_to(root).as_posix()
        for entry in place.iterdir()
        if entry.suffix.lower() in PICTURE_SUFFIXES and entry.is_file()
    )


def path(name: str) -> Path:
    """
    Return the path of a file of the course's images: a picture or a recorded flight.

    Parameters
    ----------
    name : str
        File name with its extension, such as ``"box.png"`` or ``"heldout/flight_a.bag"``.

    Raises
    ------
    MissingImageError
        No such file; the message lists what exists.
    ValueError
        The name leads out of the images' folder.
    """
    parts = PurePosixPath(name)
    if parts.is_absolute() or ".." in parts.parts:
        raise ValueError(
            f"name must be a file inside the course's images, got {name!r}; "
            "read files of your own with cv2.imread"
        )
    root = folder()
    found = root / parts
    if not found.exists() or found == root:
        raise MissingImageError(_missing(name, root, root / parts.parent))
    return found


def _missing(name: str, root: Path, place: Path) -> str:
    files = sorted(
        entry.relative_to(root).as_posix()
        for entry in (place if place.is_dir() else root).iterdir()
        if entry.is_file() and entry.suffix.lower() in (*PICTURE_SUFFIXES, ".bag")
    )
    # A forgotten extension is the commonest slip, and too far away for difflib.
    close = [file for file in files if PurePosixPath(file).with_suffix("").as_posix() == name]
    close = close or difflib.get_close_matches(name, files, n=1)
    hint = f" Did you mean {close[0]!r}?" if close else ""
    listing = ", ".join(files) if files else "nothing: the pictures have not been checked out"
    return f"No image {name!r} in {root}.{hint} There is: {listing}."


def load(name: str, *, alpha: bool = False) -> Image:
    """
    Load a course picture.

    Parameters
    ----------
    name : str
        File name with its extension; :func:`names` lists them.
    alpha : bool
        Keep the transparency as a fourth channel (opaque where the file has none).

    Returns
    -------
    ndarray of uint8, shape (H, W, 3), or (H, W, 4) with ``alpha``
        BGR, or BGRA.

    Raises
    ------
    MissingImageError
        No such picture; the message lists what exists.
    UnreadableImageError
        The file is there but cannot be decoded.
    """
    file = path(name)
    if file.suffix.lower() not in PICTURE_SUFFIXES:
        raise UnreadableImageError(
            f"{file} is not a picture ({', '.join(PICTURE_SUFFIXES)}); "
            "course_lib.camera.open_camera reads flights"
        )
    try:
        data = np.frombuffer(file.read_bytes(), np.uint8)
    except OSError as error:
        raise UnreadableImageError(f"{file} exists but cannot be read: {error}") from error
    flag = cv2.IMREAD_UNCHANGED if alpha else cv2.IMREAD_COLOR_BGR
    # imdecode raises on an empty buffer but returns None on a damaged one.
    picture = cv2.imdecode(data, flag) if data.size else None
    if picture is None:
        raise UnreadableImageError(
            f"{file} exists ({data.size} bytes) but is not a readable picture; "
            "restore it, for example with `git checkout`"
        )
    if not alpha:
        return picture.astype(np.uint8, copy=False)
    return _with_alpha(picture.astype(np.uint8, copy=False))


def _with_alpha(picture: Image) -> Image:
    if picture.ndim == 2:
        code = cv2.COLOR_GRAY2BGRA
    elif picture.shape[2] == 3:
        code = cv2.COLOR_BGR2BGRA
    else:
        return picture
    return cv2.cvtColor(picture, code).astype(np.uint8, copy=False)


def truth(name: str) -> dict[str, Any]:
    """
    Return what the renderer recorded about a picture or a flight.

    Parameters
    ----------
    name : str
        The picture's or flight's file name, as for :func:`load` and :func:`path`.

    Returns
    -------
    dict
        ``size`` is (width, height); ``camera`` holds ``K`` (3, 3) and ``T_camera_from_world``
        (4, 4), axes x right, y down, z forward; ``objects`` holds one entry for each object with
        its ``corners`` in pixels (top-left, bottom-left, bottom-right, top-right; pixel centres
        at integers). A flight has ``frames`` instead.

    Raises
    ------
    MissingImageError
        No record; the message lists the pictures that exist.
    UnreadableImageError
        The record is not JSON.
    """
    root = folder()
    parts = PurePosixPath(name)
    record = root / parts.parent / "truth" / f"{parts.stem}.json"
    if not record.is_file():
        path(name)  # a name that does not exist gets the fuller message
        raise MissingImageError(f"No truth record for {name!r}: {record} does not exist.")
    try:
        content: dict[str, Any] = json.loads(record.read_text(encoding="utf-8"))
    except ValueError as error:
        raise UnreadableImageError(f"{record} is not a readable truth record: {error}") from error
    return content


def resize(image: Image, width: int, height: int) -> Image:
    """
    Resize a picture to exactly ``width`` x ``height`` pixels.

    Shapes are (height, width) but sizes are (width, height): the commonest slip of all, so name
    the arguments: ``resize(image, width=400, height=600)``. Shrinking averages areas, because
    taking single pixels would alias fine texture into corners that are not there.

    Parameters
    ----------
    image : ndarray, shape (H, W), (H, W, 3) or (H, W, 4)
        See :func:`course_lib._validate.as_image` for the dtypes; alpha is dropped.
    width, height : int
        The new size in pixels.

    Returns
    -------
    ndarray of uint8, shape (height, width) or (height, width, 3)

    Raises
    ------
    TypeError, ValueError
        Not a picture, or a size that is not a whole number from 1 to 32767.

    Examples
    --------
    >>> import numpy as np
    >>> resize(np.zeros((100, 200, 3), np.uint8), width=50, height=40).shape
    (40, 50, 3)
    """
    checked = as_image(image, "image")
    width, height = as_count(width, "width", 1), as_count(height, "height", 1)
    if max(width, height) > MAX_SIDE:
        raise ValueError(f"width and height must be at most {MAX_SIDE}, got {width} x {height}")
    shrinks = width <= checked.shape[1] and height <= checked.shape[0]
    how = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    return cv2.resize(checked, (width, height), interpolation=how).astype(np.uint8, copy=False)
