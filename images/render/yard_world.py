"""The yard as neutral data: the one description that Blender and the simulator both build from.

Metres, z up, the well at the origin, the house to the north (+y). Nothing here imports a renderer.
`build()` gives the parts; `textures()` the pictures that they name.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import yard_textures
from numpy.typing import NDArray
from yard_shapes import Mesh, blob, box, join, moved, polygons, quad, ring, rod, tuft

Colour = tuple[int, int, int]

SUN_DIRECTION = (-0.42, -0.62, 0.66)  # from the ground towards the sun
SKY_ZENITH: Colour = (226, 158, 92)
SKY_HORIZON: Colour = (246, 232, 214)
WALL_Y = 5.0  # the plane of the house's front wall


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
        Name of a texture of `yard_textures`.
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
        return self.mesh.vertices.astype(np.float64) + np.array(self.position)


WOOD_DARK: Colour = (52, 84, 120)
ROPE: Colour = (120, 176, 206)
IRON: Colour = (70, 66, 62)


def well() -> Iterator[Part]:
    """Stone ring, roofed windlass with roller, crank, rope and bucket."""
    yield Part("well/wall", ring(0.80, 0.60, 0.0, 0.78, rows=1.0), texture="stone")
    yield Part("well/rim", ring(0.88, 0.56, 0.78, 0.90), texture="slab")
    angles = np.arange(14) * 2 * np.pi / 14
    disc = np.stack([0.6 * np.cos(angles), 0.6 * np.sin(angles), 0 * angles + 0.35], axis=1)
    fan = [(disc[0], disc[k], disc[k + 1]) for k in range(1, 13)]
    yield Part("well/water", polygons(fan), (96, 70, 40))
    posts = [moved(box((0.11, 0.11, 0.86), 0.6), (x, 0, 0.9)) for x in (-0.72, 0.72)]
    beam = moved(box((1.66, 0.09, 0.09), 0.6), (0, 0, 1.72))
    yield Part("well/posts", join([*posts, beam]), texture="wood")
    yield Part("well/roller", rod((-0.66, 0, 1.32), (0.66, 0, 1.32), (0.1, 0.1)), (96, 150, 196))
    coils = [rod((x, 0, 1.32), (x + 0.035, 0, 1.32), (0.125, 0.125)) for x in np.arange(-4, 4) / 20]
    line = rod((0.0, -0.11, 1.32), (0.0, -0.11, 1.1), (0.014, 0.014), 5)
    yield Part("well/rope", join([*coils, line]), ROPE)
    crank = [
        rod((0.6, 0, 1.32), (0.92, 0, 1.32), (0.025, 0.025)),
        rod((0.9, 0, 1.34), (0.9, -0.16, 1.08), (0.025, 0.025)),
    ]
    yield Part("well/crank", join(crank), IRON)
    yield Part("well/handle", rod((0.88, -0.16, 1.09), (1.1, -0.16, 1.09), (0.035, 0.035)), ROPE)
    yield Part("well/bucket", rod((0, -0.11, 0.86), (0, -0.11, 1.08), (0.1, 0.14), 10), WOOD_DARK)
    yield Part("well/roof", gable(2.0, 1.3, 1.66, 2.2, 0.05), texture="tiles")
    gables = [
        polygons([[(s * 0.86, -0.4 * s, 1.72), (s * 0.86, 0.4 * s, 1.72), (s * 0.86, 0, 2.06)]])
        for s in (1, -1)
    ]
    yield Part("well/gables", join(gables), WOOD_DARK)


def gable(length: float, depth: float, eaves: float, ridge: float, thick: float) -> Mesh:
    """Two roof slopes with an underside; the ridge runs along x over y = 0."""
    x, y = length / 2, depth / 2
    run = float(np.hypot(y, ridge - eaves)) / 0.9
    repeat = (length / 0.9, run)
    up = np.array([0, 0, thick])
    front = np.array([(-x, -y, eaves), (x, -y, eaves), (x, 0, ridge), (-x, 0, ridge)])
    back = front[[1, 0, 3, 2]] * (1, -1, 1)
    slopes = [quad(front + up, repeat), quad(back + up, repeat)]
    slopes += [quad(front[::-1], repeat), quad(back[::-1], repeat)]
    for side in (front, back):
        for k in (0, 1, 3):
            a, b = side[k], side[(k + 1) % 4]
            slopes.append(quad([a, b, b + up, a + up], (0.5, 0.05)))
    return join(slopes)


def house() -> Iterator[Part]:
    """Brick front with door, windows, shutters, flower boxes, tiled roof and chimney."""
    y = WALL_Y
    centre, length, depth, height = -3.2, 9.0, 4.4, 2.9
    yield Part("house/walls", box((length, depth, height), 2.0), (0, 0, 0), "brick",
               (centre, y + depth / 2, 0.0))  # fmt: skip
    yield Part("house/plinth", box((length + 0.08, depth + 0.08, 0.35), 1.2), texture="slab",
               position=(centre, y + depth / 2, 0.0))  # fmt: skip
    x = length / 2
    ends = [
        polygons([[(s * x, -s * depth / 2, height), (s * x, s * depth / 2, height),
                   (s * x, 0, height + 1.7)]])
        for s in (1, -1)
    ]  # fmt: skip
    position = (centre, y + depth / 2, 0.0)
    yield Part("house/gables", join(ends), (176, 206, 222), position=position)
    yield Part("house/roof", gable(length + 0.7, depth + 0.9, height - 0.12, height + 1.8, 0.1),
               texture="tiles", position=position)  # fmt: skip
    chimney = moved(box((0.6, 0.6, 1.5), 1.6), (-5.4, y + 2.6, height + 0.9))
    yield Part("house/chimney", chimney, texture="brick")
    yield Part("house/door", on_wall(-1.35, 0.0, 1.05, 2.1, 0.06), texture="door")
    frame = [on_wall(-1.35 + s * 0.6, 0, 0.16, 2.26, 0.1) for s in (-1, 1)]
    frame.append(on_wall(-1.35, 2.1, 1.36, 0.16, 0.1))
    yield Part("house/door_frame", join(frame), (210, 222, 228))
    step = moved(box((1.5, 0.5, 0.14), 1.0), (-1.35, y - 0.25, 0.0))
    yield Part("house/step", step, texture="slab")
    columns = (-6.4, -3.7, 0.35)
    panes = [on_wall(wx, 1.0, 1.0, 1.15, 0.05) for wx in columns]
    yield Part("house/windows", join(panes), texture="window")
    leaves = [on_wall(wx + s * 0.72, 1.0, 0.4, 1.15, 0.06) for wx in columns for s in (-1, 1)]
    yield Part("house/shutters", join(leaves), (120, 96, 38))
    boxes = [moved(box((1.1, 0.24, 0.2)), (wx, y - 0.12, 0.78)) for wx in columns]
    yield Part("house/flower_boxes", join(boxes), WOOD_DARK)
    rng = np.random.default_rng(21)
    for index, colour in enumerate(((60, 60, 220), (60, 200, 240), (190, 90, 220))):
        flowers = [
            moved(blob((0.07, 0.07, 0.07), rng), (wx + dx, y - 0.14 + dy, 1.03))
            for wx in columns
            for dx, dy in rng.uniform((-0.5, -0.07), (0.5, 0.07), (5, 2))
        ]
        yield Part(f"house/flowers_{index}", join(flowers), colour)


def on_wall(x: float, z: float, width: float, height: float, thick: float) -> Mesh:
    """Board on the front wall, centred at ``x``, its foot at ``z``; its front is textured."""
    y0, y1 = WALL_Y, WALL_Y - thick
    left, right, top = x - width / 2, x + width / 2, z + height
    sides = moved(box((width, thick, height)), (x, (y0 + y1) / 2, z))
    sides = sides._replace(uv=np.full_like(sides.uv, 0.02))
    face = quad([(left, y1 - 0.002, z), (right, y1 - 0.002, z), (right, y1 - 0.002, top),
                 (left, y1 - 0.002, top)])  # fmt: skip
    return join([sides, face])


def bench() -> Iterator[Part]:
    """A wooden bench at the wall."""
    boards = [moved(box((1.7, 0.11, 0.05), 0.5), (0, dy, 0.44)) for dy in (-0.16, 0.0, 0.16)]
    boards += [moved(box((1.7, 0.04, 0.12), 0.5), (0, 0.26, z)) for z in (0.6, 0.78)]
    boards += [moved(box((0.08, 0.4, 0.44), 0.5), (x, 0, 0)) for x in (-0.7, 0.7)]
    boards += [moved(box((0.08, 0.06, 0.9), 0.5), (x, 0.26, 0)) for x in (-0.7, 0.7)]
    place = (-3.7, WALL_Y - 0.75, 0.0)
    yield Part("bench/boards", join(boards), texture="wood", position=place)


def garden() -> Iterator[Part]:
    """Lawn, path, hedges, fence, trees, tufts, flower pots, logs."""
    rng = np.random.default_rng(22)
    lawn = quad([(-40, -40, 0), (40, -40, 0), (40, 40, 0), (-40, 40, 0)], (16, 16))
    yield Part("garden/lawn", lawn, texture="grass")
    z = 0.012
    path = [
        quad([(-1.9, 2.9, z), (-0.8, 2.9, z), (-0.8, 4.6, z), (-1.9, 4.6, z)], (0.6, 0.9)),
        quad([(-1.5, 1.2, z), (-0.2, 0.8, z), (-0.8, 2.9, z), (-1.9, 2.9, z)], (0.6, 1.0)),
    ]
    yield Part("garden/path", join(path), texture="paving")
    octagon = np.arange(12) * 2 * np.pi / 12
    stand = np.stack([1.45 * np.cos(octagon), 1.45 * np.sin(octagon), 0 * octagon + 0.008], axis=1)
    fan = [(stand[0], stand[k], stand[k + 1]) for k in range(1, 11)]
    yield Part("garden/stand", polygons(fan, np.array(fan)[..., :2] / 1.8), texture="paving")
    hedges = [moved(box((0.9, 7.5, 1.25), 0.9), (6.2, 0.8, 0)), moved(box((4.0, 0.9, 1.0), 0.9),
              (3.9, 5.9, 0)), moved(box((0.9, 9.0, 1.1), 0.9), (-9.2, 0.0, 0))]  # fmt: skip
    yield Part("garden/hedges", join(hedges), texture="leaves")
    yield Part("garden/fence", join(list(fence())), (214, 226, 232))
    spots = [(8.2, 7.5, 1.25), (4.9, 10.5, 1.5), (-9.8, 5.5, 1.3), (9.5, 1.0, 1.2),
             (-11.0, -3, 1.4), (12.5, 13.0, 1.9), (-13.5, 12.0, 1.8), (1.5, 16.0, 1.7)]  # fmt: skip
    trunks = [rod((x, y, 0), (x, y, 2.2 * s), (0.2 * s, 0.13 * s), 7) for x, y, s in spots]
    yield Part("garden/trunks", join(trunks), WOOD_DARK)
    crowns = [
        moved(blob((1.1 * s, 1.1 * s, 1.0 * s), rng), (x + dx * s, y + dy * s, (2.6 + dz) * s))
        for x, y, s in spots
        for dx, dy, dz in ((0, 0, 0.5), (0.6, 0.2, 0), (-0.55, -0.1, 0.05))
    ]
    yield Part("garden/crowns", join(crowns), texture="leaves")
    yield from small_things(rng)


def fence() -> Iterator[Mesh]:
    """White pickets with two rails: east of the house, and along the south."""
    for start, end in (((1.6, 7.2), (12.0, 7.2)), ((-9.0, -9.5), (9.0, -9.5))):
        a, b = np.array(start), np.array(end)
        turn = float(np.degrees(np.arctan2(*(b - a)[::-1])))
        count = int(np.hypot(*(b - a)) / 0.24)
        for t in np.linspace(0, 1, count):
            x, y = a + t * (b - a)
            yield moved(box((0.11, 0.03, 0.95)), (x, y, 0), turn)
        middle = (a + b) / 2
        for height in (0.25, 0.7):
            rail = box((float(np.hypot(*(b - a))), 0.04, 0.08))
            yield moved(rail, (middle[0], middle[1] + 0.035, height), turn)


def small_things(rng: np.random.Generator) -> Iterator[Part]:
    """Tufts, daisies, pots, logs."""
    places = rng.uniform((-8.5, -8.5), (5.6, 4.6), (260, 2))
    places = places[np.hypot(*places.T) > 1.6]
    for index, colour in enumerate(((46, 128, 84), (58, 148, 106), (70, 160, 128))):
        chosen = places[index::3]
        tufts = [moved(tuft(rng), (x, y, 0), float(rng.uniform(0, 360))) for x, y in chosen]
        yield Part(f"garden/tufts_{index}", join(tufts), colour)
    daisies = rng.uniform((-7, -7), (5, 4), (90, 2))
    daisies = daisies[np.hypot(*daisies.T) > 1.6]
    heads = [moved(blob((0.035, 0.035, 0.02), rng), (x, y, 0.07)) for x, y in daisies]
    yield Part("garden/daisies", join(heads[:60]), (236, 244, 246))
    yield Part("garden/dandelions", join(heads[60:]), (60, 214, 244))
    pots = [moved(rod((0, 0, 0), (0, 0, 0.36), (0.14, 0.2), 8), p) for p in
            ((-0.45, 4.6, 0), (-2.3, 4.6, 0), (1.9, 4.55, 0))]  # fmt: skip
    yield Part("garden/pots", join(pots), (84, 118, 200))
    bushes = [moved(blob((0.26, 0.26, 0.3), rng), (p.vertices[:, 0].mean(),
              p.vertices[:, 1].mean(), 0.56)) for p in pots]  # fmt: skip
    yield Part("garden/pot_bushes", join(bushes), texture="leaves")
    logs = [rod((x, -0.55, z), (x, 0.55, z), (0.13, 0.13), 8) for x, z in
            ((-0.26, 0.13), (0.0, 0.13), (0.26, 0.13), (-0.13, 0.355), (0.13, 0.355),
             (0, 0.58))]  # fmt: skip
    yield Part("garden/logs", join(logs), texture="wood", position=(3.4, 1.6, 0.0))


def person() -> Iterator[Part]:
    """A low-poly gardener who looks at the drone."""
    place = (-3.1, 1.5, 0.0)
    skin: Colour = (140, 178, 226)
    legs = [rod((x, 0, 0.06), (x * 0.9, 0, 0.86), (0.085, 0.1), 7) for x in (-0.11, 0.11)]
    yield Part("person/trousers", join(legs), (128, 74, 44), position=place)
    shoes = [moved(box((0.12, 0.28, 0.09)), (x, -0.05, 0)) for x in (-0.11, 0.11)]
    yield Part("person/shoes", join(shoes), (40, 46, 60), position=place)
    shirt = [
        rod((0, 0, 0.84), (0, 0, 1.42), (0.19, 0.24), 8),
        rod((-0.22, 0, 1.38), (-0.4, -0.02, 1.0), (0.075, 0.06), 6),
        rod((0.22, 0, 1.38), (0.5, -0.1, 1.52), (0.075, 0.06), 6),
    ]
    yield Part("person/shirt", join(shirt), (58, 170, 236), position=place)
    hands = [rod((-0.4, -0.02, 1.0), (-0.43, -0.05, 0.78), (0.05, 0.045), 6),
             rod((0.5, -0.1, 1.52), (0.58, -0.14, 1.78), (0.05, 0.045), 6),
             rod((0, 0, 1.42), (0, 0, 1.5), (0.06, 0.06), 6)]  # fmt: skip
    head = moved(blob((0.13, 0.14, 0.16), np.random.default_rng(3), rough=0.02), (0, 0, 1.62))
    yield Part("person/skin", join([*hands, head]), skin, position=place)
    eyes = [moved(blob((0.018, 0.012, 0.022), np.random.default_rng(4)), (x, -0.13, 1.65))
            for x in (-0.05, 0.05)]  # fmt: skip
    yield Part("person/eyes", join(eyes), (30, 30, 30), position=place)
    hat = [rod((0, 0, 1.7), (0, 0, 1.73), (0.27, 0.25), 10), rod((0, 0, 1.73), (0, 0, 1.86),
           (0.15, 0.11), 8)]  # fmt: skip
    yield Part("person/hat", join(hat), (110, 200, 230), position=place)


def distance() -> Iterator[Part]:
    """Hills and clouds beyond the garden."""
    rng = np.random.default_rng(23)
    hills = [
        moved(
            blob((14, 10, rng.uniform(2.5, 5.5)), rng, rough=0.06),
            (36 * np.cos(a), 36 * np.sin(a), -0.6),
        )
        for a in np.arange(12) * 2 * np.pi / 12 + rng.uniform(-0.1, 0.1, 12)
    ]
    yield Part("distance/hills", join(hills), (88, 150, 112))
    clouds = []
    for a in np.radians((20, 62, 88, 118, 160, 215, 250, 300, 340)):
        centre = np.array([70 * np.cos(a), 70 * np.sin(a), rng.uniform(17, 27)])
        for _ in range(4):
            shift = rng.uniform((-5, -5, -0.8), (5, 5, 0.8))
            clouds.append(moved(blob((4.2, 4.2, 1.8), rng), centre + shift))
    yield Part("distance/clouds", join(clouds), (252, 252, 252))


def build() -> list[Part]:
    """All parts of the yard, in a fixed order."""
    groups = (well, house, bench, garden, person, distance)
    return [part for group in groups for part in group()]


def textures() -> dict[str, NDArray[np.uint8]]:
    """The pictures that parts name: BGR uint8, row 0 at the top."""
    return yard_textures.make_all()


def triangles(parts: Sequence[Part]) -> NDArray[np.float64]:
    """All facets of the parts as corner points, float64 (M, 3, 3), metres."""
    return np.concatenate([part.world_vertices()[part.mesh.faces] for part in parts])
