"""Made-up surfaces: wood, cloth and blur behind a mug, another print for another mug."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib.scenes import heldout
from course_lib.scenes.resample import Canvas, enlarge, opaque

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from course_lib._validate import Image

BACKDROPS = ("wood", "cloth", "blur")
WOODS = ((34, 68, 112), (52, 92, 140), (78, 120, 165), (40, 52, 74))
CLOTHS = ((120, 84, 60), (84, 60, 120), (70, 96, 84), (150, 140, 128), (60, 70, 150))
INKS = ((40, 40, 40), (150, 90, 20), (40, 110, 200), (60, 140, 40), (160, 40, 130), (30, 30, 170))
PRINT_SIZE = (480, 400)  # width, height of another mug's print, flat


def backdrop(kind: str, rng: np.random.Generator, avoid: int) -> Image:
    """
    Make what stands behind the template's mug.

    None of them shows an object: a book behind the mug that stood in the scene as well would be
    found there, rightly, by any matcher.

    Parameters
    ----------
    kind : {"wood", "cloth", "blur"}
    rng : numpy.random.Generator
    avoid : int
        The background not to use for "blur": it is in the scene.

    Returns
    -------
    ndarray of uint8, shape (600, 400, 3)
    """
    height, width = 600, 400
    if kind == "blur":
        number = int(rng.choice([n for n in range(heldout.N_BACKGROUNDS) if n != avoid]))
        top, left = int(rng.integers(0, 41)), int(rng.integers(0, 300))
        part = heldout.background(number)[top : top + 560, left : left + 560]
        blocks = part.reshape(14, 40, 14, 40, 3).astype(np.int64).sum(axis=(1, 3)) // 1600
        return _to_uint8(enlarge(blocks, height, width))
    if kind == "wood":
        colour = np.array(WOODS[int(rng.integers(len(WOODS)))])
        # Grain runs along the boards: noise that is fine across and coarse along them.
        grain = enlarge(rng.integers(-22, 23, (7, 70)), height, width)
        grain += enlarge(rng.integers(-10, 11, (30, 200)), height, width)
        if rng.random() < 0.5:
            grain = np.ascontiguousarray(grain.T)
            grain = enlarge(grain, height, width)
    else:
        colour = np.array(CLOTHS[int(rng.integers(len(CLOTHS)))])
        # Folds, and a weave that is one grey level strong.
        grain = enlarge(rng.integers(-28, 29, (6, 5)), height, width)
        grain += rng.integers(-4, 5, (height, width))
    shaded = colour * (256 + 3 * grain[..., None]) // 256
    return _to_uint8(shaded)


def light(rng: np.random.Generator, height: int, width: int, strength: int) -> NDArray[np.int32]:
    """Return uneven light as factors times 256, shape (height, width): smooth, 256 at its mean."""
    corners = 256 + rng.integers(-strength, strength + 1, (3, 3))
    return enlarge(corners, height, width)


def _to_uint8(values: NDArray[np.integer]) -> Image:
    return np.asarray(np.clip(values, 0, 255), np.uint8)


@cache
def blank_mug(number: int) -> Image:
    """Return mug ``number`` without its print, premultiplied BGRA: white, with its shading."""
    mug = heldout.mug_cut_out(number).copy()
    solid = mug[..., 3] > 250
    # Ceramic is the brightest thing around each spot of ink.
    bright = cv2.dilate(mug[..., :3], np.ones((25, 25), np.uint8)).astype(np.int64)
    smooth = _box_mean(bright, 12)
    ink = solid & ((bright - mug[..., :3]).max(axis=2) > 14)
    corners, grid = heldout.print_places(number)
    hull = cv2.convexHull(np.concatenate([corners, grid]).astype(np.float32)).astype(np.int32)
    printed = cv2.fillConvexPoly(np.zeros(mug.shape[:2], np.uint8), hull, 1)
    printed = cv2.dilate(printed, np.ones((15, 15), np.uint8))
    near_ink = cv2.dilate(ink.astype(np.uint8), np.ones((5, 5), np.uint8))
    region = (printed > 0) & (near_ink > 0)
    mug[..., :3][region & solid] = smooth[region & solid].astype(np.uint8)
    mug.flags.writeable = False
    return mug


def _box_mean(values: NDArray[np.int64], radius: int) -> NDArray[np.int64]:
    size = 2 * radius + 1
    for axis in (0, 1):
        edge = [(radius + 1, radius) if axis == side else (0, 0) for side in range(values.ndim)]
        sums = np.pad(values, edge, mode="edge").cumsum(axis=axis)
        count = values.shape[axis]
        high = np.take(sums, range(size, size + count), axis=axis)
        values = (high - np.take(sums, range(count), axis=axis)) // size
    return values


def other_mug(number: int, rng: np.random.Generator) -> Canvas:
    """
    Return a mug of the same make with another print: bright shapes, no two alike.

    Parameters
    ----------
    number : int
        Which view of a mug to print on.
    rng : numpy.random.Generator

    Returns
    -------
    Canvas
    """
    width, height = PRINT_SIZE
    flat = np.zeros((height, width, 4), np.uint8)
    for _ in range(int(rng.integers(16, 30))):
        ink = (*INKS[int(rng.integers(len(INKS)))], 255)
        centre = np.array([rng.integers(20, width - 20), rng.integers(20, height - 20)])
        reach = int(rng.integers(14, 60))
        sides = int(rng.integers(3, 7))
        around = rng.integers(-reach, reach + 1, (sides, 2))
        shape = cv2.convexHull((centre + around).astype(np.int32))
        cv2.fillConvexPoly(flat, shape, ink)
        if rng.random() < 0.4:
            cv2.fillConvexPoly(flat, centre + (shape - centre) // 2, (235, 235, 235, 255))
    source = np.array([[0, 0], [0, height - 1], [width - 1, height - 1], [width - 1, 0]])
    to_mug = cv2.getPerspectiveTransform(
        source.astype(np.float32), heldout.print_places(number)[0].astype(np.float32)
    )
    mug = blank_mug(number).astype(np.uint16)
    box = (0, 0, mug.shape[1], mug.shape[0])
    ink_layer = Canvas(flat).warp(np.asarray(to_mug, np.float64), box).astype(np.uint16)
    # Ink darkens the ceramic under it, so that the mug's shading stays.
    clear = 255 - ink_layer[..., 3:]
    mug[..., :3] = mug[..., :3] * np.minimum(ink_layer[..., :3] + clear, 255) // 255
    return Canvas(mug.astype(np.uint8))


def photo_card(rng: np.random.Generator, number: int) -> Canvas:
    """
    Return a printed photograph with a white border: what lies before a covered mug.

    Parameters
    ----------
    rng : numpy.random.Generator
    number : int
        The background it shows a part of.

    Returns
    -------
    Canvas
        As large as ``CARD_SIZE`` says.
    """
    width, height = CARD_SIZE
    top, left = int(rng.integers(100, 601 - height)), int(rng.integers(0, 901 - width))
    card = heldout.background(number)[top : top + height, left : left + width].copy()
    card[:8] = card[-8:] = 225
    card[:, :8] = card[:, -8:] = 225
    return Canvas(opaque(card))


CARD_SIZE = (300, 240)  # width, height
