"""Frames of a held-out flight around the well, with where the well is in each."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from course_lib._validate import Image, as_count
from course_lib.camera import open_camera
from course_lib.scenes import camera, heldout

if TYPE_CHECKING:
    from numpy.typing import NDArray

FLIGHTS = ("flight_a.bag", "flight_b.bag")
TURNS_AWAY = FLIGHTS[0]  # the one in which the drone loses sight of the well altogether
WHOLE = 0.99  # a silhouette with at least this much in the frame counts as whole
ABSENT = 0.001
N_FRAMES = (6, 48)
FRAME_NS = 100_000_000
STREAM = 0x666C79


@dataclass(frozen=True, eq=False)
class HeldOutFrame:
    """
    A frame of a flight, and the well in it.

    Attributes
    ----------
    image : ndarray of uint8, shape (480, 640, 3)
        BGR, read-only.
    stamp_ns : int
        When it was taken, nanoseconds.
    polygon : ndarray of float32, shape (N, 2), or None
        The well's silhouette, (x, y), cut off by the frame's border where the well is; None where
        the well is not in the frame.
    visible : float
        The share of the silhouette that is in the frame.
    whole : bool
        Whether all of it is.
    """

    image: Image
    stamp_ns: int
    polygon: NDArray[np.float32] | None
    visible: float
    whole: bool


@dataclass(frozen=True, eq=False)
class Flight:
    """Frames in the order of their stamps, a tenth of a second apart."""

    frames: list[HeldOutFrame]


def flight(seed: int, *, n_frames: int = 24) -> Flight:
    """
    Make a held-out flight from a seed: the same seed, the same pixels.

    The drone looks at the well, turns away from it and finds it again. Half of the frames or more
    show the whole well, a sixth or more do not show it at all, in a few it is cut off by the
    frame's border. Exposure, white balance and noise are the seed's; the geometry is untouched.

    Parameters
    ----------
    seed : int
        Not negative.
    n_frames : int
        From 6 to 48.

    Returns
    -------
    Flight
        Shared between calls with the same arguments: copy a picture before drawing on it.

    Raises
    ------
    MissingHeldOutError
        The held-out flights are not here.
    TypeError, ValueError
        A wrong seed or number of frames.
    """
    seed, n_frames = as_count(seed, "seed", 0), as_count(n_frames, "n_frames", N_FRAMES[0])
    if n_frames > N_FRAMES[1]:
        raise ValueError(f"n_frames must be at most {N_FRAMES[1]}, got {n_frames}")
    return Flight(list(_flight(seed, n_frames)))


def yard_without_well(seed: int, *, n_frames: int = 6) -> list[HeldOutFrame]:
    """
    Make frames of the yard in which the well is not, from a seed.

    Parameters
    ----------
    seed : int
        Not negative.
    n_frames : int
        From 1 to 12.

    Returns
    -------
    list of HeldOutFrame
        All with ``polygon`` None. Copy a picture before drawing on it.
    """
    seed, n_frames = as_count(seed, "seed", 0), as_count(n_frames, "n_frames", 1)
    absent = _numbers(TURNS_AWAY, 0.0, ABSENT)
    if n_frames > len(absent):
        raise ValueError(f"n_frames must be at most {len(absent)}, got {n_frames}")
    return list(_yard(seed, n_frames))


@lru_cache(maxsize=4)
def _flight(seed: int, n_frames: int) -> tuple[HeldOutFrame, ...]:
    rng = np.random.default_rng([STREAM, seed])
    name = FLIGHTS[int(rng.integers(len(FLIGHTS)))]
    n_absent = -(-n_frames // 6) + int(rng.integers(0, 1 + n_frames // 12))
    n_partial = max(1, n_frames // 12)
    n_whole = n_frames - n_absent - n_partial
    whole = _spread(_numbers(name, WHOLE, 2.0), n_whole, rng)
    partial = _spread(_numbers(name, 0.3, WHOLE), n_partial, rng)
    absent = _spread(_numbers(TURNS_AWAY, 0.0, ABSENT), n_absent, rng)
    # The drone turns away after some frames, and comes back to the others.
    turn = int(rng.integers(n_whole // 4, n_whole - n_whole // 4))
    chosen = [(name, number) for number in whole[:turn]]
    chosen += [(name, number) for number in partial]
    chosen += [(TURNS_AWAY, number) for number in absent]
    chosen += [(name, number) for number in whole[turn:]]
    return _frames(chosen, rng)


@lru_cache(maxsize=4)
def _yard(seed: int, n_frames: int) -> tuple[HeldOutFrame, ...]:
    rng = np.random.default_rng([STREAM, seed, 1])
    absent = _spread(_numbers(TURNS_AWAY, 0.0, ABSENT), n_frames, rng)
    return _frames([(TURNS_AWAY, number) for number in absent], rng)


def _numbers(name: str, low: float, high: float) -> list[int]:
    """Return the numbers of the frames with low <= visible < high."""
    shown = [entry["well"]["visible"] for entry in heldout.record(name)["frames"]]
    return [number for number, visible in enumerate(shown) if low <= visible < high]


def _spread(numbers: list[int], count: int, rng: np.random.Generator) -> list[int]:
    """Draw ``count`` numbers, one from each of equally long stretches, in order."""
    edges = np.linspace(0, len(numbers), count + 1)
    places = edges[:-1] + rng.random(count) * np.diff(edges)
    return [numbers[int(place)] for place in places]


def _frames(chosen: list[tuple[str, int]], rng: np.random.Generator) -> tuple[HeldOutFrame, ...]:
    """Read the chosen frames and change their light, the same way for all but the noise."""
    pictures = _read(chosen)
    level, warmth = rng.uniform(0.8, 1.15), rng.uniform(-0.07, 0.07)
    gains = (level * (1 - warmth), level, level * (1 + warmth))
    sigma = rng.uniform(0.5, 3.0)
    start = 1_770_000_000_000_000_000 + int(rng.integers(10_000)) * FRAME_NS
    frames = []
    for place, key in enumerate(chosen):
        image = camera.noisy(camera.exposed(pictures[key][0], gains), rng, sigma)
        image.flags.writeable = False
        well = pictures[key][1]["well"]
        visible = float(well["visible"])
        seen = visible >= ABSENT
        polygon = np.array(well["polygon"], np.float32).reshape(-1, 2) if seen else None
        stamp = start + place * FRAME_NS
        frames.append(HeldOutFrame(image, stamp, polygon, visible, visible >= WHOLE))
    return tuple(frames)


def _read(chosen: list[tuple[str, int]]) -> dict[tuple[str, int], tuple[Image, dict[str, Any]]]:
    # Reading a whole flight takes 0.1 s, keeping it 65 MB: only the frames asked for are kept.
    wanted = set(chosen)
    pictures = {}
    for name in sorted({name for name, _ in wanted}):
        with open_camera(heldout.flight_path(name)) as source:
            for number, frame in enumerate(source):
                if (name, number) in wanted:
                    pictures[name, number] = (frame.image, frame.truth or {})
    return pictures
