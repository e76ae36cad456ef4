"""One piece of the yard: a mesh of one material."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from course_lib.yard.shapes import Mesh

Colour = tuple[int, int, int]

WOOD_DARK: Colour = (52, 84, 120)
ROPE: Colour = (120, 176, 206)
IRON: Colour = (70, 66, 62)


@dataclass(frozen=True)
class Part:
    """One mesh of one material.

    Attributes
    ----------
    name : str
        "group/part", such as "well/rim".
    mesh : Mesh
        Vertices in metres relative to ``position``, faces, uv.
    colour : (blue, green, red), 0–255
        Flat colour; unused where there is a texture.
    texture : str or None
        Name of a texture of `course_lib.yard.textures`.
    position : (x, y, z), metres
    """

    name: str
    mesh: Mesh
    colour: Colour = (255, 255, 255)
    texture: str | None = None
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def group(self) -> str:
        """What the part belongs to: the name before the slash."""
        return self.name.split("/")[0]

    def world_vertices(self) -> NDArray[np.float64]:
        """Vertices (N, 3) in the world's axes, metres."""
        return np.asarray(self.mesh.vertices + np.array(self.position, np.float64), np.float64)
