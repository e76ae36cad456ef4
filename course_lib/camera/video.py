"""Frames from video files, webcams and network streams."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib.camera.frames import CameraError, Frame, FrameSource, TruthByStamp

if TYPE_CHECKING:
    from collections.abc import Iterator

VIDEO_SUFFIXES = (".mp4", ".avi", ".mov", ".mkv", ".webm", ".m4v", ".mpg", ".mpeg", ".ogv")

# Used for a file that does not say; most cameras do this.
USUAL_RATE = 30.0


class VideoSource(FrameSource):
    """
    A video file, a webcam or a network stream.

    Parameters
    ----------
    source : Path, int or str
        A video file; a webcam's number; or a device or address that OpenCV opens.

    Raises
    ------
    CameraError
        It cannot be opened.
    """

    def __init__(self, source: Path | int | str) -> None:
        super().__init__(f"webcam {source}" if isinstance(source, int) else str(source))
        self._is_file = isinstance(source, Path)
        self._capture = cv2.VideoCapture(source if isinstance(source, int) else str(source))
        if not self._capture.isOpened():
            self._release()
            raise CameraError(
                f"{self.name} is not a video that OpenCV can read"
                if self._is_file
                else f"{self.name} cannot be opened: is it connected, and free?"
            )
        rate = self._capture.get(cv2.CAP_PROP_FPS)
        self._rate = rate if 0 < rate < 1000 else USUAL_RATE
        self._count = int(self._capture.get(cv2.CAP_PROP_FRAME_COUNT)) if self._is_file else -1
        self._truth = TruthByStamp(source) if isinstance(source, Path) else None

    def __len__(self) -> int:
        return self._count if self._count > 0 else super().__len__()

    def _read(self) -> Iterator[Frame]:
        number, last_ns = 0, -1
        while True:
            arrived, picture = self._capture.read()
            if not arrived:
                self._finish(number)
                return
            if self._is_file:
                # The file's own clock, which phones do not run evenly; some files have none.
                stamp_ns = round(self._capture.get(cv2.CAP_PROP_POS_MSEC) * 1e6)
                if stamp_ns <= last_ns:
                    stamp_ns = max(last_ns + 1, round(number * 1e9 / self._rate))
            else:
                stamp_ns = time.time_ns()
            truth = self._truth.at(stamp_ns) if self._truth else None
            yield Frame(stamp_ns, picture.astype(np.uint8, copy=False), truth)
            number, last_ns = number + 1, stamp_ns

    def _finish(self, number: int) -> None:
        if not self._is_file:
            raise CameraError(f"{self.name} stopped delivering pictures after {number}")
        if number == 0:
            raise CameraError(f"{self.name} holds no picture that can be decoded")

    def _release(self) -> None:
        self._capture.release()
