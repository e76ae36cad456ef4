"""A mug alone, and a scene in which it stands somewhere, with the exact homography."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from course_lib._validate import Image, as_count
from course_lib.homography import project, template_corners
from course_lib.scenes import camera, heldout, texture
from course_lib.scenes.poses import KIND_RANGES, MUG_SIZE, SCENE_SIZE, random_homography, times
from course_lib.scenes.resample import Box, Canvas, blend

if TYPE_CHECKING:
    from numpy.typing import NDArray

KINDS = tuple(KIND_RANGES)
COVER = (0.2, 0.45)  # how much of a covered mug is hidden
STREAM = 0x6D7567  # keeps these draws apart from those of flights with the same seed


@dataclass(frozen=True, eq=False)
class MugScene:
    """
    A mug, and a scene that shows it or does not.

    Attributes
    ----------
    mug : ndarray of uint8, shape (600, 400, 3)
        The template, BGR.
    scene : ndarray of uint8, shape (400, 600, 3)
        BGR.
    corners : ndarray of float32, shape (4, 2), or None
        Where the template's corner pixels' centres are in the scene: top left, bottom left,
        bottom right, top right of the template. They always lie in the scene. None where the mug
        is absent.
    homography : ndarray of float64, shape (3, 3), or None
        H_scene_from_template, exact: pixel centres at integers.
    kind : str
        One of ``KINDS``.
    hidden : float
        The share of the mug that something stands before.
    """

    mug: Image
    scene: Image
    corners: NDArray[np.float32] | None
    homography: NDArray[np.float64] | None
    kind: str
    hidden: float = 0.0


def mug_scene(seed: int, *, kind: str | None = None) -> MugScene:
    """
    Make a held-out mug and a scene from a seed: the same seed, the same pixels.

    Parameters
    ----------
    seed : int
        Not negative.
    kind : str or None
        What is hard about it, one of ``KINDS``: "plain", "rotation" (any angle), "scale" (far
        away), "tilt" (seen from the side), "dim" (dim warm light), "noise" (a bad sensor), "cover"
        (partly hidden), "absent" (no mug, or one with another print). None draws one.

    Returns
    -------
    MugScene

    Raises
    ------
    MissingHeldOutError
        The held-out pictures are not here.
    TypeError, ValueError
        A wrong seed or kind.

    Notes
    -----
    The result is shared between calls with the same arguments, and read-only: the scenes of one
    grading are made once and not for every student. Copy a picture before drawing on it.
    """
    seed = as_count(seed, "seed", 0)
    if kind is None:
        kind = KINDS[int(np.random.default_rng([STREAM, seed]).integers(len(KINDS)))]
    if kind not in KINDS:
        raise ValueError(f"unknown kind {kind!r}; choose from {', '.join(KINDS)}")
    return _made(seed, kind)


# About 1.5 MB each: a grading's scenes stay, memory does not grow.
@lru_cache(maxsize=48)
def _made(seed: int, kind: str) -> MugScene:
    made = _make(seed, kind)
    for array in (made.mug, made.scene, made.corners, made.homography):
        if array is not None:
            array.flags.writeable = False
    return made


def _make(seed: int, kind: str) -> MugScene:
    rng = np.random.default_rng([STREAM, seed, KINDS.index(kind)])
    number = int(rng.integers(heldout.N_MUGS))
    behind = int(rng.integers(heldout.N_BACKGROUNDS))
    H_template_from_mug = _placed(number, rng)
    mug = _template(number, H_template_from_mug, behind, rng)
    scene = _background(behind, rng)
    H = random_homography(kind, rng)
    if kind == "absent":
        if rng.random() < 0.5:
            other = texture.other_mug(number, rng)
            _put(scene, other, times(H, H_template_from_mug), heldout.mug_box(number))
        return MugScene(mug, camera.small_change(scene, rng), None, None, kind)
    shown = _put(
        scene, heldout.mug_canvas(number), times(H, H_template_from_mug), heldout.mug_box(number)
    )
    hidden = _cover(scene, shown, behind, rng) if kind == "cover" else 0.0
    scene = camera.dimmed(scene, rng) if kind == "dim" else camera.small_change(scene, rng)
    if kind == "noise":
        scene = camera.bad_sensor(scene, rng)
    corners = project(H, template_corners(MUG_SIZE).astype(np.float64)).astype(np.float32)
    return MugScene(mug, scene, corners, H, kind, hidden)


def _placed(number: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """H_template_from_mug: enlarged to fill the template, a little off its middle."""
    left, top, right, bottom = heldout.mug_box(number)
    wide, high = right - left, bottom - top
    scale = float(rng.uniform(0.85, 0.95)) * min(MUG_SIZE[0] / wide, 0.86 * MUG_SIZE[1] / high)
    room = np.array(MUG_SIZE) - scale * np.array([wide, high])
    x, y = room * rng.uniform(0.3, 0.7, 2)
    return np.array([[scale, 0, x - scale * left], [0, scale, y - scale * top], [0, 0, 1.0]])


def _template(
    number: int, H_template_from_mug: NDArray[np.float64], behind: int, rng: np.random.Generator
) -> Image:
    kind = texture.BACKDROPS[int(rng.integers(len(texture.BACKDROPS)))]
    picture = texture.backdrop(kind, rng, avoid=behind)
    _put(picture, heldout.mug_canvas(number), H_template_from_mug, heldout.mug_box(number))
    return camera.noisy(picture, rng, 1.0)


def _background(number: int, rng: np.random.Generator) -> Image:
    """Return a part of a background, a little turned."""
    shrink = float(rng.uniform(0.72, 0.95))
    turn = math.radians(float(rng.uniform(-3, 3)))
    cosine, sine = shrink * math.cos(turn), shrink * math.sin(turn)
    around = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1.0]])
    corners = project(around, np.array([[0, 0], [0, 599], [899, 599], [899, 0]], np.float64))
    # The largest upright rectangle inside is approximated by the inner corners.
    xs, ys = np.sort(corners[:, 0]), np.sort(corners[:, 1])
    spare = np.array([xs[2] - xs[1], ys[2] - ys[1]]) - np.array(SCENE_SIZE)
    start = np.array([xs[1], ys[1]]) + spare * rng.random(2)
    around[:2, 2] = -start
    box = (0, 0, *SCENE_SIZE)
    return heldout.background_canvas(number).warp(around, box, samples=1)[..., :3].copy()


def _put(picture: Image, canvas: Canvas, H: NDArray[np.float64], part: Box) -> tuple[Image, Box]:
    """Lay the part of a canvas into a picture; return its alpha and where that is."""
    left, top, right, bottom = part
    around = np.array([[left, top], [left, bottom], [right, bottom], [right, top]], np.float64)
    mapped = project(H, around)
    size = picture.shape[1::-1]
    low = np.clip(np.floor(mapped.min(axis=0)).astype(int) - 2, 0, size)
    high = np.clip(np.ceil(mapped.max(axis=0)).astype(int) + 3, 0, size)
    box = (int(low[0]), int(low[1]), int(high[0]), int(high[1]))
    warped = canvas.warp(H, box)
    blend(picture, warped, box)
    return warped[..., 3], box


def _cover(scene: Image, shown: tuple[Image, Box], behind: int, rng: np.random.Generator) -> float:
    """Lay a photograph over a part of the mug, in place; return how much of the mug it hides."""
    alpha, (left, top, right, bottom) = shown
    number = int(rng.choice([n for n in range(heldout.N_BACKGROUNDS) if n != behind]))
    card = texture.photo_card(rng, number)
    turn, away = (float(rng.uniform(0, 2 * math.pi)) for _ in range(2))
    target = float(rng.uniform(COVER[0] + 0.02, COVER[1] - 0.02))
    scale = float(rng.uniform(0.8, 1.0))
    cosine, sine = scale * math.cos(turn), scale * math.sin(turn)
    width, height = texture.CARD_SIZE
    middle = np.array([(left + right) / 2, (top + bottom) / 2])
    total = int(alpha.sum(dtype=np.int64))
    tried = []
    # Pushed from far outside towards the middle: the place that hides most nearly what it should.
    for distance in np.linspace(260, 0, 53):
        x, y = middle + distance * np.array([math.cos(away), math.sin(away)])
        H = np.array([[cosine, -sine, x], [sine, cosine, y], [0, 0, 1.0]])
        H[:2, 2] -= H[:2, 0] * (width - 1) / 2 + H[:2, 1] * (height - 1) / 2
        inside = _inside(H, (width, height), (left, top, right, bottom))
        tried.append((int(alpha[inside].sum(dtype=np.int64)) / total, H))
    hidden, H = min(tried, key=lambda each: abs(each[0] - target))
    _put(scene, card, H, (0, 0, width, height))
    return hidden


def _inside(H: NDArray[np.float64], size: tuple[int, int], box: Box) -> NDArray[np.bool_]:
    """Tell for each pixel of the box whether a turned rectangle covers it."""
    left, top, right, bottom = box
    x, y = np.meshgrid(np.arange(left, right) - H[0, 2], np.arange(top, bottom) - H[1, 2])
    square = H[0, 0] ** 2 + H[1, 0] ** 2
    u, v = (x * H[0, 0] + y * H[1, 0]) / square, (x * H[0, 1] + y * H[1, 1]) / square
    inside = (u >= -0.5) & (v >= -0.5) & (u <= size[0] - 0.5) & (v <= size[1] - 0.5)
    return np.asarray(inside, np.bool_)
