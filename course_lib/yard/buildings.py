"""What people built in the yard: the well, the house, the bench."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from course_lib.yard.part import IRON, ROPE, WOOD_DARK, Part
from course_lib.yard.shapes import blob, box, join, moved, polygons, quad, ring, rod

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_lib.yard.shapes import Mesh


WALL_Y = 5.0  # the plane of the house's front wall


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
    """Make a wooden bench at the wall."""
    boards = [moved(box((1.7, 0.11, 0.05), 0.5), (0, dy, 0.44)) for dy in (-0.16, 0.0, 0.16)]
    boards += [moved(box((1.7, 0.04, 0.12), 0.5), (0, 0.26, z)) for z in (0.6, 0.78)]
    boards += [moved(box((0.08, 0.4, 0.44), 0.5), (x, 0, 0)) for x in (-0.7, 0.7)]
    boards += [moved(box((0.08, 0.06, 0.9), 0.5), (x, 0.26, 0)) for x in (-0.7, 0.7)]
    place = (-3.7, WALL_Y - 0.75, 0.0)
    yield Part("bench/boards", join(boards), texture="wood", position=place)
