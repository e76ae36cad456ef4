"""Who looks on, and what lies beyond the garden."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from course_lib.yard.part import Part
from course_lib.yard.shapes import blob, box, join, moved, rod

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_lib.yard.part import Colour


def person() -> Iterator[Part]:
    """Make a low-poly gardener who looks at the drone."""
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
