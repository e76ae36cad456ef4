"""Where the mug is put: a flat template seen by a camera, for each kind of scene."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from course_lib.homography import project, template_corners

if TYPE_CHECKING:
    from numpy.typing import NDArray

MUG_SIZE = (400, 600)  # width, height of the template
SCENE_SIZE = (600, 400)
MARGIN = 3.0  # the outline keeps this far from the scene's border, pixels
FOCAL = 900.0  # the camera's focal length, pixels: how strong the perspective is


@dataclass(frozen=True)
class Ranges:
    """From which ranges a kind draws: degrees and scene pixels per template pixel."""

    turn: tuple[float, float] = (-12, 12)
    tilt: tuple[float, float] = (0, 10)
    scale: tuple[float, float] = (0.5, 0.62)


KIND_RANGES = {
    "plain": Ranges(tilt=(0, 6)),
    "rotation": Ranges(turn=(25, 335), scale=(0.46, 0.55)),
    "scale": Ranges(scale=(0.34, 0.44)),
    "tilt": Ranges(tilt=(26, 42)),
    "dim": Ranges(),
    "noise": Ranges(),
    "cover": Ranges(),
    "absent": Ranges(),
}


def random_homography(kind: str, rng: np.random.Generator) -> NDArray[np.float64]:
    """
    Draw H_scene_from_template such that the whole outline lies in the scene.

    Parameters
    ----------
    kind : str
        A key of ``KIND_RANGES``.
    rng : numpy.random.Generator

    Returns
    -------
    ndarray of float64, shape (3, 3), with H[2, 2] = 1
    """
    ranges = KIND_RANGES[kind]
    turn, tilt, scale = (
        float(rng.uniform(*each)) for each in (ranges.turn, ranges.tilt, ranges.scale)
    )
    towards = float(rng.uniform(0, 360))
    place = rng.random(2)
    low, high = _extent(view(turn, tilt, towards, scale))
    room = np.array(SCENE_SIZE) - 1 - 2 * MARGIN
    # Perspective is not linear in the scale, but a smaller outline always fits in the end.
    while ((high - low) > room).any():
        scale *= 0.98
        low, high = _extent(view(turn, tilt, towards, scale))
    corner = MARGIN + place * (room - (high - low))
    shift = np.eye(3)
    shift[:2, 2] = corner - low
    H = times(shift, view(turn, tilt, towards, scale))
    return np.asarray(H / H[2, 2])


def view(turn: float, tilt: float, towards: float, scale: float) -> NDArray[np.float64]:
    """
    Return the homography of a camera that looks at the template's middle.

    Parameters
    ----------
    turn : float
        Rotation in the picture, degrees, clockwise on screen.
    tilt : float
        Angle between the template's normal and the line of sight, degrees.
    towards : float
        Which way it leans, degrees.
    scale : float
        Scene pixels for each template pixel at the middle.

    Returns
    -------
    ndarray of float64, shape (3, 3)
        The middle of the template is sent to (0, 0).
    """
    spin, lean = math.radians(turn), math.radians(towards)
    axis = _about_z(lean)
    cosine, sine = math.cos(math.radians(tilt)), math.sin(math.radians(tilt))
    about_x = np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])
    rotation = times(times(times(axis, about_x), axis.T), _about_z(spin))
    middle = (np.array(MUG_SIZE) - 1) / 2
    distance = FOCAL / scale
    pose = np.column_stack([rotation[:, :2], [0, 0, distance]])
    centred = np.array([[1, 0, -middle[0]], [0, 1, -middle[1]], [0, 0, 1]])
    return times(times(np.diag([FOCAL, FOCAL, 1.0]), pose), centred)


def times(A: NDArray[np.float64], B: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return A times B, both (3, 3), added up in one order: BLAS's depends on the processor."""
    return np.array(
        [
            [A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j] for j in range(3)]
            for i in range(3)
        ]
    )


def _about_z(angle: float) -> NDArray[np.float64]:
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1.0]])


def _extent(H: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    outline = project(H, template_corners(MUG_SIZE).astype(np.float64))
    return outline.min(axis=0), outline.max(axis=0)
