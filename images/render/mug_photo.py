"""ROS.png: the mug, close, in front of wood. Exercise 4.1's template."""

from __future__ import annotations

from typing import TYPE_CHECKING

import materials
import mug
import sensor
import studio

if TYPE_CHECKING:
    from pathlib import Path

NAME, SIZE = "ROS.png", (600, 900)


def main(out: Path, *, preview: bool) -> None:
    """Take the photograph."""
    scene = studio.fresh_scene(*SIZE, samples=20 if preview else 128, seed=2)
    planks = materials.wood("planks", rings=18, dark=materials.rgb("#54341c"))
    studio.add_box(scene, "table", (1.2, 0.9, 0.03), planks, location=(0, 0.1, -0.015))
    for k in range(7):
        wall = materials.wood(f"wall {k}", rings=13 + 2 * k, light=materials.rgb("#b07f4c"))
        studio.add_box(
            scene, f"plank {k}", (1.4, 0.02, 0.068), wall,
            location=(0.11 * k, 0.16, 0.035 + 0.07 * k), bevel=0.002,
        )  # fmt: skip
    cup = mug.add_mug(scene, yaw=-4)
    studio.set_world(scene, (0.95, 0.97, 1.0), 0.35)
    studio.add_area_light(scene, (-0.5, -0.7, 0.55), (0, 0, 0.05), size=0.35, power=11)
    studio.add_area_light(
        scene, (0.6, -0.35, 0.35), (0, 0, 0.05), size=0.12, power=2.2, colour=(1, 0.85, 0.66)
    )
    studio.add_camera(scene, (0.0, -0.40, 0.115), (0.006, 0, 0.05), lens=76, f_stop=7)
    about = mug.record(scene, cup)
    picture = sensor.expose(studio.render(scene), seed=11, blur=0.7, electrons=4000)
    sensor.save(out / NAME, picture)
    mug.write_truth(out, NAME, scene, about)
