"""The yard as a MuJoCo model: batches of facets that share a texture, their light baked in.

Nothing is lit while it is drawn. Facets of one colour lie on a palette, textured ones are grouped
by their tint, and shadows on the lawn and the house are dark, half transparent sheets just in front
of them. So a frame costs some 150 calls and no shading, and software renders it in real time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from course_lib.yard import bake, world
from course_lib.yard.bake import GROUND, UNIT, WALL
from course_lib.yard.light import GAMMA, sky
from course_lib.yard.shapes import Mesh, quad

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from course_lib.yard.part import Part

WELL = "well"  # names of the well's geoms begin so
PALETTE = 128  # texels a side
HEADROOM = 1.2  # textures are stored brighter by this, since a tint cannot exceed 1
STEPS = 14.0  # tints are told apart in steps of 1 / STEPS
SHADOW_BGR = (26, 14, 8)


@dataclass(frozen=True)
class Batch:
    """Facets drawn in one call.

    Attributes
    ----------
    name, texture : str
    tint : (red, green, blue, alpha)
        0 to 1; the texture is multiplied by it.
    mesh : Mesh
    """

    name: str
    texture: str
    tint: tuple[float, ...]
    mesh: Mesh


def batches(parts: list[Part], light: bake.Baked) -> tuple[list[Batch], NDArray[np.uint8]]:
    """Group the facets of all parts.

    Parameters
    ----------
    parts : list of Part
        As `world.build()` gives them.
    light : Baked

    Returns
    -------
    batches : list of Batch
    palette : ndarray of uint8, shape (PALETTE, PALETTE, 3)
        BGR; the texture "palette".
    """
    groups: dict[tuple[Any, ...], list[tuple[Any, ...]]] = {}
    colours: dict[tuple[int, ...], int] = {}
    start = 0
    for part in parts:
        facets = light.facets[start : start + len(part.mesh.faces)] / UNIT
        start += len(part.mesh.faces)
        corners = part.world_vertices()[part.mesh.faces]
        uv = part.mesh.uv[part.mesh.faces].astype(float)
        side = WELL if part.group == WELL else "yard"
        texture = part.texture
        if texture is None:
            # Two grey values apart are one colour: the palette stays small.
            shades = np.clip(np.array(part.colour) * facets, 0, 254).astype(int) // 3 * 3 + 1
            cells = [colours.setdefault(tuple(shade), len(colours)) for shade in shades.tolist()]
            row, column = np.divmod(np.array(cells), PALETTE)
            uv[:] = np.stack([column + 0.5, PALETTE - row - 0.5], axis=1)[:, None] / PALETTE
            groups.setdefault((side, "palette", (1.0, 1.0, 1.0)), []).append((corners, uv))
            continue
        levels = np.rint(np.minimum(facets[:, ::-1] / HEADROOM, 1) * STEPS) / STEPS
        outside = np.zeros(len(corners), bool)
        if part.name == "well/wall":
            middle = corners.mean(axis=1)
            outside = np.hypot(middle[:, 0], middle[:, 1]) > 0.75
            unlit = (side, "well_stone", (1.0, 1.0, 1.0))
            groups.setdefault(unlit, []).append((corners[outside], uv[outside]))
        for level in np.unique(levels[~outside], axis=0):
            chosen = (levels == level).all(axis=1) & ~outside
            key = (side, texture, tuple(level.tolist()))
            groups.setdefault(key, []).append((corners[chosen], uv[chosen]))
    palette = np.zeros((PALETTE * PALETTE, 3), np.uint8)
    palette[: len(colours)] = list(colours)
    made = [
        Batch(f"{side}_{number}", texture, (*tint, 1.0), _mesh(pieces))
        for number, ((side, texture, tint), pieces) in enumerate(groups.items())
    ]
    return made, palette.reshape(PALETTE, PALETTE, 3)


def _mesh(pieces: list[tuple[Any, ...]]) -> Mesh:
    corners = np.concatenate([piece[0] for piece in pieces]).reshape(-1, 3)
    uv = np.concatenate([piece[1] for piece in pieces]).reshape(-1, 2)
    faces = np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    return Mesh(corners.astype(np.float32), faces, uv.astype(np.float32))


def shadow_sheets() -> Iterator[Batch]:
    """Give the sheets that darken the lawn and the house's front."""
    west, south, size = GROUND
    z = 0.02
    ground = [(west, south, z), (west + size, south, z), (west + size, south + size, z),
              (west, south + size, z)]  # fmt: skip
    yield Batch("yard_ground_shadow", "ground_shadow", (1, 1, 1, 0.99), quad(ground))
    west, length, height = WALL
    y = world.WALL_Y - 0.012
    front = [(west, y, 0), (west + length, y, 0), (west + length, y, height), (west, y, height)]
    yield Batch("yard_wall_shadow", "wall_shadow", (1, 1, 1, 0.99), quad(front))


def textures(light: bake.Baked, palette: NDArray[np.uint8]) -> dict[str, NDArray[np.uint8]]:
    """Give every texture by name: BGR or BGRA uint8, row 0 at the top."""
    plain = world.textures()
    made = {
        name: np.clip(picture * HEADROOM, 0, 255).astype(np.uint8)
        for name, picture in plain.items()
    }
    made["palette"] = palette
    stone = plain["stone"].astype(float)
    rows, columns = stone.shape[:2]
    # Linear interpolation between the samples, round the well and down it.
    row = np.clip((np.arange(rows) + 0.5) / rows * len(light.well) - 0.5, 0, len(light.well) - 1)
    column = (np.arange(columns) + 0.5) / columns * light.well.shape[1] - 0.5
    lit = _between(light.well / UNIT, row, 0)
    lit = _between(lit, column, 1)
    made["well_stone"] = np.clip(stone * lit, 0, 255).astype(np.uint8)
    for name, darkness in (("ground_shadow", light.ground), ("wall_shadow", light.wall)):
        colour = np.broadcast_to(np.array(SHADOW_BGR, np.uint8), (*darkness.shape, 3))
        made[name] = np.dstack([colour, darkness])
    return made


def _between(values: NDArray[np.float64], at: NDArray[np.float64], axis: int) -> Any:  # noqa: ANN401
    low = np.floor(at).astype(int)
    share = (at - low).reshape([-1 if a == axis else 1 for a in range(3)])
    size = values.shape[axis]
    return (1 - share) * values.take(low % size, axis) + share * values.take((low + 1) % size, axis)


def sky_box(size: int = 128) -> dict[str, NDArray[np.uint8]]:
    """Give the sky's six faces as squares, BGR: the same gradient as in the recorded flights."""
    a = (np.arange(size) + 0.5) / size * 2 - 1
    across, down = np.meshgrid(a, a)
    one = np.ones_like(across)

    def face(x: Any, y: Any, z: Any) -> NDArray[np.uint8]:  # noqa: ANN401 (arrays)
        ways = np.stack([x, y, z], axis=2).reshape(-1, 3)
        ways /= np.linalg.norm(ways, axis=1)[:, None]
        shown = 255 * np.clip(sky(ways), 0, 1) ** (1 / GAMMA)
        return np.rint(shown).astype(np.uint8).reshape(size, size, 3)

    side = face(across, one, -down)
    return {"side": side, "up": face(across, down, one), "down": face(across, down, -one)}
