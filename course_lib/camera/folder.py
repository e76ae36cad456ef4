"""Frames from a folder of pictures, in the natural order of their names."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib.camera.frames import CameraError, Frame, FrameSource, read_truth

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

FOLDER_SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp")

# Nanoseconds since 1970 have 19 digits; EuRoC and TUM-VI name their pictures so.
STAMPED_NAME = re.compile(r"\d{16,19}")


class FolderSource(FrameSource):
    """
    The pictures of a folder.

    Parameters
    ----------
    place : Path
    rate : float
        Frames per second, unless the files are named by their time in nanoseconds.

    Raises
    ------
    CameraError
        No picture in the folder, or a rate that is not positive.
    """

    def __init__(self, place: Path, *, rate: float) -> None:
        super().__init__(str(place))
        if not 0 < rate < float("inf"):
            raise CameraError(f"rate must be a positive number of frames per second, got {rate}")
        self._files = sorted(
            (entry for entry in place.iterdir() if entry.suffix.lower() in FOLDER_SUFFIXES),
            key=_natural,
        )
        if not self._files:
            raise CameraError(f"{place} holds no pictures ({', '.join(FOLDER_SUFFIXES)})")
        self._period_ns = 1e9 / rate
        self._stamped = all(STAMPED_NAME.fullmatch(file.stem) for file in self._files)

    def __len__(self) -> int:
        return len(self._files)

    def _read(self) -> Iterator[Frame]:
        for number, file in enumerate(self._files):
            try:
                data = np.frombuffer(file.read_bytes(), np.uint8)
            except OSError as error:
                raise CameraError(f"{file} exists but cannot be read: {error}") from error
            picture = cv2.imdecode(data, cv2.IMREAD_COLOR_BGR) if data.size else None
            if picture is None:
                raise CameraError(f"{file} exists ({data.size} bytes) but is no readable picture")
            stamp_ns = int(file.stem) if self._stamped else round(number * self._period_ns)
            yield Frame(stamp_ns, picture.astype(np.uint8, copy=False), read_truth(file))

    def _release(self) -> None:
        """Each file is closed as soon as it is read."""


def _natural(file: Path) -> list[tuple[int, str]]:
    # frame_2 before frame_10.
    return [
        (int(part), "") if part.isdigit() else (-1, part)
        for part in re.findall(r"[0-9]+|[^0-9]+", file.name)
    ]
