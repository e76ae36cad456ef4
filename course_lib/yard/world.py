"""The yard as neutral data: the one description that Blender and the simulator both build from.

Metres, z up, the well at the origin, the house to the north (+y). Nothing here imports a renderer.
`build()` gives the parts; `textures()` the pictures that they name.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from course_lib.yard.buildings import WALL_Y, bench, house, well
from course_lib.yard.garden import garden
from course_lib.yard.surroundings import distance, person
from course_lib.yard.textures import make_all

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from course_lib.yard.part import Colour, Part

__all__ = [
    "SKY_HORIZON",
    "SKY_ZENITH",
    "SUN_DIRECTION",
    "WALL_Y",
    "build",
    "textures",
    "triangles",
    "well",
]

SUN_DIRECTION = (-0.42, -0.62, 0.66)  # from the ground towards the sun
SKY_ZENITH: Colour = (226, 158, 92)
SKY_HORIZON: Colour = (246, 232, 214)


def build() -> list[Part]:
    """All parts of the yard, in a fixed order."""
    groups = (well, house, bench, garden, person, distance)
    return [part for group in groups for part in group()]


def textures() -> dict[str, NDArray[np.uint8]]:
    """Give the pictures that parts name: BGR uint8, row 0 at the top."""
    return make_all()


def triangles(parts: Sequence[Part]) -> NDArray[np.float64]:
    """Give all facets of the parts as corner points, float64 (M, 3, 3), metres."""
    return np.concatenate([part.world_vertices()[part.mesh.faces] for part in parts])
