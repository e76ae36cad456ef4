"""heldout/mug_1.png … mug_6.png: the mug alone, cut out, from several sides and in several lights.

Held-out scenes are composed from these, so no student's code has met them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import mug
import numpy as np
import sensor
import studio

if TYPE_CHECKING:
    from pathlib import Path

SIZE = (520, 520)


@dataclass(frozen=True)
class View:
    """How one picture is taken.

    Attributes
    ----------
    yaw : float
        Of the mug, degrees.
    height : float
        Of the camera above the mug's foot, metres.
    distance : float
        Metres.
    roll : float
        Degrees.
    light : (x, power, (r, g, b))
        Side, power and colour of the main light.
    """

    yaw: float
    height: float
    distance: float
    roll: float
    light: tuple[float, float, tuple[float, float, float]]


VIEWS = (
    View(0, 0.09, 0.55, 0, (-0.5, 11, (1, 1, 1))),
    View(14, 0.16, 0.55, 3, (-0.6, 11, (1, 0.93, 0.82))),
    View(-16, 0.13, 0.52, -4, (0.6, 10, (0.9, 0.95, 1))),
    View(6, 0.24, 0.55, 8, (0.3, 9, (1, 0.97, 0.92))),
    View(-8, 0.05, 0.6, -9, (-0.3, 6, (1, 0.85, 0.68))),
    View(20, 0.19, 0.5, 5, (0.5, 13, (0.95, 0.98, 1))),
)


def main(out: Path, *, preview: bool) -> None:
    """Take all six."""
    for number, view in enumerate(VIEWS, 1):
        name = f"mug_{number}.png"
        scene = studio.fresh_scene(
            *SIZE, samples=16 if preview else 80, seed=60 + number, transparent=True
        )
        cup = mug.add_mug(scene, yaw=view.yaw, handle=0.5 + 0.15 * number)
        studio.set_world(scene, (0.95, 0.97, 1.0), 0.45)
        x, power, colour = view.light
        studio.add_area_light(
            scene, (x, -0.7, 0.5), (0, 0, 0.05), size=0.35, power=power, colour=colour
        )
        studio.add_area_light(scene, (-x, -0.3, 0.4), (0, 0, 0.05), size=0.15, power=1.6)
        studio.add_camera(
            scene, (0.01, -view.distance, view.height), (0.012, 0, 0.048), lens=105,
            roll=np.radians(view.roll),
        )  # fmt: skip
        about = mug.record(scene, cup)
        drawn = studio.render(scene)
        seen = sensor.expose(drawn[..., :3], seed=70 + number, blur=0.5, electrons=6000)
        # Beyond the mug there is nothing: no noise either, so that the file stays small.
        seen[drawn[..., 3] == 0] = 0
        sensor.save(out / "heldout" / name, cv2.merge([*cv2.split(seen), drawn[..., 3]]))
        mug.write_truth(out / "heldout", name, scene, about)
