"""Keep the yard's light in a file: `python -m course_lib.yard.bake` works it out again.

It takes some ten seconds, which nobody should wait for when the drone takes off. The file holds one
colour factor for each facet of `world.build()`, and pictures of the shadows where facets are large.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from course_lib.yard import world
from course_lib.yard.light import Light, tint

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from course_lib.yard.part import Part

FILE = Path(__file__).parent / "light.npz"
UNIT = 170  # stored value of the factor 1: up to 1.5 fits into a byte

# What lies flat under open sky; its shadows are pictures, not facets.
OPEN = ("garden/lawn", "garden/stand", "garden/path", "house/walls")
# Sunlight comes through a cloud and out of it below, evenly; linear BGR.
CLOUDS, THROUGH_CLOUDS = "distance/clouds", np.array([0.62, 0.55, 0.50])
SMALL = ("tufts", "daisies", "dandelions", "flowers", "eyes")
GROUND = (-11.0, -11.0, 22.0)  # west, south, size, metres
WALL = (-7.7, 9.0, 2.9)  # west, length, height of the house's front
WELL_RADIUS, WELL_HEIGHT = 0.80, 0.78


@dataclass(frozen=True)
class Baked:
    """The light of the yard; factors are stored colours' (BGR), `UNIT` means unchanged.

    Attributes
    ----------
    facets : ndarray of uint8, shape (M, 3)
        For each facet of all parts, in order.
    ground, wall : ndarray of uint8, shape (rows, columns)
        How dark the shadow is, 255 black; row 0 is north, or the top.
    well : ndarray of uint8, shape (rows, columns, 3)
        Factors round the well's outside: column 0 is the texture's left, row 0 the top.
    """

    facets: NDArray[np.uint8]
    ground: NDArray[np.uint8]
    wall: NDArray[np.uint8]
    well: NDArray[np.uint8]


def _stored(factor: NDArray[np.float64]) -> NDArray[np.uint8]:
    return np.clip(np.rint(factor * UNIT), 0, 255).astype(np.uint8)


def _facets(part: Part, light: Light) -> NDArray[np.uint8]:
    corners = part.world_vertices()[part.mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    normals /= areas[:, None] + 1e-12
    total = np.zeros((len(corners), 3))
    weights = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4], [2, 2, 2]]) / 6
    for weight in weights:
        points = np.einsum("k,mkd->md", weight, corners)
        total += light.falling_on(points, normals, shadows=part.name not in OPEN) / len(weights)
    if part.name == CLOUDS:
        total = np.maximum(total, THROUGH_CLOUDS)
    # The triangles of one polygon are one surface: without a common shade their seam would show.
    _, polygon = np.unique(part.mesh.faces[:, 0], return_inverse=True)
    whole = np.maximum(np.bincount(polygon, areas), 1e-12)
    shared = [np.bincount(polygon, areas * channel) / whole for channel in total.T]
    return _stored(tint(np.stack(shared, axis=1)[polygon]))


def _shadow(
    light: Light, points: NDArray[np.float64], normal: Sequence[float]
) -> NDArray[np.uint8]:
    flat = points.reshape(-1, 3)
    normals = np.broadcast_to(np.asarray(normal, float), flat.shape)
    lit = tint(light.falling_on(flat, normals)).mean(axis=1)
    unlit = tint(light.falling_on(flat, normals, shadows=False)).mean(axis=1)
    darkness = np.clip(255 * (1 - lit / unlit), 0, 255)
    return np.asarray(np.rint(darkness.reshape(points.shape[:2])), np.uint8)


def compute() -> Baked:
    """Work the light out."""
    parts = world.build()
    solid = [
        part
        for part in parts
        if part.group != "distance"
        and part.name not in OPEN[:3]
        and not any(word in part.name for word in SMALL)
    ]
    light = Light(world.triangles(solid))
    west, south, size = GROUND
    x = west + (np.arange(440) + 0.5) * size / 440
    y = south + size - (np.arange(440) + 0.5) * size / 440
    ground = np.stack([*np.meshgrid(x, y), np.full((440, 440), 0.03)], axis=2)
    west, length, height = WALL
    x = west + (np.arange(360) + 0.5) * length / 360
    z = height - (np.arange(116) + 0.5) * height / 116
    front = np.stack(np.meshgrid(x, z), axis=2)
    front = np.insert(front, 1, world.WALL_Y - 0.02, axis=2)
    return Baked(
        np.concatenate([_facets(part, light) for part in parts]),
        _shadow(light, ground, (0, 0, 1)),
        _shadow(light, front, (0, -1, 0)),
        _round_the_well(light),
    )


def _round_the_well(light: Light) -> NDArray[np.uint8]:
    turn = (np.arange(168) + 0.5) / 168 * 2 * np.pi + np.pi / 14
    z = WELL_HEIGHT - (np.arange(32) + 0.5) / 32 * WELL_HEIGHT
    turns, heights = np.meshgrid(turn, z)
    normals = np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=2)
    points = normals * WELL_RADIUS + heights[..., None] * [0, 0, 1]
    lit = light.falling_on(points.reshape(-1, 3), normals.reshape(-1, 3))
    return _stored(tint(lit)).reshape(32, 168, 3)


def load() -> Baked:
    """Read the stored light."""
    with np.load(FILE) as stored:
        return Baked(**{name: stored[name] for name in Baked.__dataclass_fields__})


def main() -> None:
    """Work the light out and store it."""
    np.savez_compressed(FILE, **asdict(compute()))


if __name__ == "__main__":
    main()
