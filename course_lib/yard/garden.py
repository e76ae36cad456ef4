"""What grows in the yard and what stands about in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from course_lib.yard.part import WOOD_DARK, Part
from course_lib.yard.shapes import blob, box, join, moved, polygons, quad, rod, tuft

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_lib.yard.shapes import Mesh


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
