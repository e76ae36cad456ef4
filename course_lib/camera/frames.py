"""What every camera source has in common: timestamped frames, one iterator, one error."""

from __future__ import annotations

import bisect
import json
from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from pathlib import Path
    from types import TracebackType

    from course_lib._validate import Image

# A stamp that went through floating-point seconds is off by up to about 200 ns; frames of any
# camera are much further apart than this.
STAMP_TOLERANCE_NS = 500_000


class CameraError(OSError):
    """A camera source cannot be opened or read; the message says what to do."""


@dataclass(frozen=True, eq=False)
class Frame:
    """
    One picture of a camera.

    Attributes
    ----------
    stamp_ns : int
        When it was taken, in nanoseconds: the message's own stamp for a recording, the time since
        the start for a video file or a folder, the time since 1970 for a webcam.
    image : ndarray of uint8, shape (H, W, 3)
        BGR.
    truth : dict or None
        What the renderer recorded about this frame, where a truth record exists.
    """

    stamp_ns: int
    image: Image
    truth: dict[str, Any] | None = None

    def __repr__(self) -> str:
        # The dataclass's own would print the pixels.
        height, width = self.image.shape[:2]
        known = "known" if self.truth else "unknown"
        return f"Frame(stamp_ns={self.stamp_ns}, image {width} x {height}, truth {known})"


class FrameSource(Iterator[Frame]):
    """
    An iterator of frames that is also a context manager.

    Attributes
    ----------
    name : str
        What is being read, for messages.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self._frames: Iterator[Frame] | None = None
        self._closed = False

    @abstractmethod
    def _read(self) -> Iterator[Frame]:
        """Yield the frames; whatever it opens is closed by :meth:`_release`."""

    @abstractmethod
    def _release(self) -> None:
        """Let go of files and devices; may be called again."""

    def __next__(self) -> Frame:
        if self._closed:
            raise StopIteration
        if self._frames is None:
            self._frames = self._read()
        try:
            return next(self._frames)
        except BaseException:
            # The end of the frames, damage, or an interrupt: nothing more will come.
            self.close()
            raise

    def __len__(self) -> int:
        raise TypeError(f"{self.name} does not say how many frames it has")

    def __bool__(self) -> bool:
        # Without this, truth would ask __len__, which some sources cannot answer.
        return True

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r})"

    def close(self) -> None:
        """Let go of the source; no more frames come."""
        self._closed = True
        self._release()

    @property
    def closed(self) -> bool:
        """Whether the source has been closed."""
        return self._closed


class TruthByStamp:
    """
    The truth records of a recording's frames, found by time.

    Parameters
    ----------
    recording : Path
        The recording; its record is ``truth/<stem>.json`` beside it, and may be absent.
    """

    def __init__(self, recording: Path) -> None:
        record = read_truth(recording)
        frames = sorted((record or {}).get("frames", []), key=lambda entry: entry["stamp_ns"])
        self._frames: list[dict[str, Any]] = frames
        self._stamps: list[int] = [entry["stamp_ns"] for entry in frames]

    def at(self, stamp_ns: int) -> dict[str, Any] | None:
        """Return the record of the frame taken at ``stamp_ns``, None if there is none."""
        place = bisect.bisect_left(self._stamps, stamp_ns)
        near = self._frames[max(0, place - 1) : place + 1]
        best = min(near, key=lambda entry: abs(entry["stamp_ns"] - stamp_ns), default=None)
        if best is None or abs(best["stamp_ns"] - stamp_ns) > STAMP_TOLERANCE_NS:
            return None
        return best


def read_truth(file: Path) -> dict[str, Any] | None:
    """
    Return the truth record beside a picture or a recording, None if there is none.

    Raises
    ------
    CameraError
        The record is damaged.
    """
    file = file.resolve()  # a link's truth is that of what it leads to
    record = file.parent / "truth" / f"{file.stem}.json"
    if not record.is_file():
        return None
    try:
        content: dict[str, Any] = json.loads(record.read_text(encoding="utf-8"))
    except ValueError as error:
        raise CameraError(f"{record} is not a readable truth record: {error}") from error
    return content
