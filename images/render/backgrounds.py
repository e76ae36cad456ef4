"""heldout/background_1.jpg … background_4.jpg: shelves and desks without the mug."""

from __future__ import annotations

from typing import TYPE_CHECKING

import box_scenes
import props
import sensor
import shelf
import studio
import truth

if TYPE_CHECKING:
    from pathlib import Path

    import bpy

SIZE = (900, 600)


def _shelf(scene: bpy.types.Scene, seed: int, power: float) -> None:
    shelf.build(scene, seed, gap=(0.02 * seed - 0.2, 0.02 * seed + 0.02))
    props.can(scene, 30 + seed, location=(-0.2, -0.02, 0))
    props.can(scene, 60 + seed, location=(0.19, -0.03, 0))
    props.die(scene, 46 + seed, location=(0.07, -0.05, 0), turn=0.9)
    props.book(scene, 80 + seed, (0.17, 0.12, 0.024), location=(-0.04, 0.0, 0.012))
    shelf.light(scene, power=power)


def _desk(scene: bpy.types.Scene, power: float) -> None:
    box_scenes.table(scene)
    props.book(scene, 91, (0.22, 0.16, 0.03), location=(0.03, 0.03, 0.015), rotation=(0, 0, 0.4))
    props.can(scene, 35, location=(-0.1, -0.05, 0))
    studio.set_world(scene, (0.9, 0.95, 1.0), 0.35)
    studio.add_area_light(scene, (-1.0, -0.1, 1.2), (0, 0.1, 0), size=0.7, power=power)


def main(out: Path, *, preview: bool) -> None:
    """Take all four."""
    cameras = (
        ((0.05, -0.66, 0.17), (0.0, 0, 0.10), 44),
        ((-0.12, -0.6, 0.22), (0.04, 0, 0.08), 46),
        ((0.1, -0.62, 0.5), (0.0, 0.1, 0.0), 38),
        ((-0.3, -0.5, 0.42), (0.03, 0.12, 0.0), 40),
    )
    for number, (camera, target, lens) in enumerate(cameras, 1):
        name = f"background_{number}.jpg"
        scene = studio.fresh_scene(*SIZE, samples=12 if preview else 64, seed=80 + number)
        if number <= 2:
            _shelf(scene, 10 + number, 30 - 8 * number)
        else:
            _desk(scene, 34 if number == 3 else 15)
        studio.add_camera(scene, camera, target, lens=lens, f_stop=10)
        picture = sensor.expose(
            studio.render(scene), seed=90 + number, blur=0.7, electrons=3200 - 500 * number
        )
        sensor.save(out / "heldout" / name, picture, quality=88)
        about = {"image": name, "size": SIZE, "camera": truth.camera_record(scene), "objects": {}}
        truth.write(out / "heldout" / "truth" / f"background_{number}.json", about)
