"""The box on a cluttered table, three times: tilted, turned in dim light, and partly hidden."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import materials
import numpy as np
import props
import sensor
import studio
import truth
from box_cover import SIZE, cover

if TYPE_CHECKING:
    from pathlib import Path

    import bpy

PICTURE = (640, 480)
BOX = (0.30, 0.21, 0.055)  # metres


@dataclass(frozen=True)
class View:
    """One photograph of the table.

    Attributes
    ----------
    name : str
        File name of the picture.
    turn : float
        Of the box about the vertical, degrees.
    place : (x, y)
        Of the box on the table, metres.
    camera, target : (x, y, z)
        Metres.
    lens : float
        Millimetres.
    hidden : bool
        Whether things lie on the box.
    light : (power, (r, g, b))
        Of the window.
    lamp : float
        Power of the reading lamp that glares on the cover.
    noise : float
        Electrons of a white pixel; fewer is noisier.
    """

    name: str
    turn: float
    place: tuple[float, float]
    camera: tuple[float, float, float]
    target: tuple[float, float, float]
    lens: float
    hidden: bool
    light: tuple[float, tuple[float, float, float]]
    lamp: float
    noise: float


VIEWS = (
    View("box_in_scene.png", 24, (0.03, 0.02), (0.02, -0.50, 0.74), (0.0, 0.045, 0.02), 45, False,
         (26, (1, 0.97, 0.92)), 4, 3200),
    View("box_in_scene_rotated.png", 151, (-0.03, 0.03), (0.14, -0.46, 0.78), (0.0, 0.04, 0.02), 45,
         False, (9, (1, 0.82, 0.6)), 5, 2000),
    View("box_in_scene_hidden.png", -17, (0.02, 0.03), (-0.1, -0.46, 0.78), (0.0, 0.045, 0.02), 46,
         True, (24, (0.92, 0.96, 1)), 3, 4500),
)  # fmt: skip


def table(scene: bpy.types.Scene) -> None:
    """Lay the table: wood, books, cans, pencils, dice."""
    top = materials.wood("table", rings=14)
    studio.add_box(scene, "table", (2.4, 1.8, 0.04), top, location=(0, 0.3, -0.02))
    wall = materials.plain("wall", materials.rgb("#b9b2a4"), roughness=0.9)
    studio.add_box(scene, "wall", (4, 0.05, 2), wall, location=(0, 1.2, 0.9))
    books = [
        (11, (0.24, 0.17, 0.035), (-0.36, 0.22, 0.0175), 0.3),
        (12, (0.21, 0.15, 0.028), (-0.35, 0.22, 0.049), -0.15),
        (13, (0.25, 0.18, 0.04), (0.40, 0.25, 0.02), -0.35),
        (14, (0.19, 0.13, 0.022), (0.39, 0.24, 0.051), 0.1),
        (15, (0.22, 0.15, 0.03), (0.02, 0.36, 0.015), 0.05),
        (16, (0.2, 0.14, 0.026), (0.01, 0.36, 0.043), -0.2),
        (17, (0.2, 0.14, 0.03), (-0.36, -0.13, 0.015), 1.2),
        (18, (0.2, 0.14, 0.024), (0.36, -0.1, 0.012), -1.0),
    ]
    for seed, size, location, turn in books:
        props.book(scene, seed, size, location=location, rotation=(0, 0, turn))
    for seed, x, y in ((31, -0.2, 0.27), (32, 0.23, 0.3), (33, 0.29, 0.12), (31, -0.14, 0.33)):
        props.can(scene, seed, location=(x, y, 0))
    colours = ("#c0392b", "#e0a526", "#2e6da4", "#3c8d4f", "#7a4b94")
    for k, colour in enumerate(colours):
        props.pencil(scene, colour, location=(-0.27 + 0.016 * k, -0.06, 0.004), turn=0.2 + 0.13 * k)
        props.pencil(scene, colour, location=(0.3 + 0.014 * k, -0.17, 0.004), turn=-0.8 + 0.1 * k)
    dice = ((41, -0.13, -0.17, 0.3), (42, -0.09, -0.2, 0.9), (43, 0.17, -0.19, 0.5))
    for seed, x, y, turn in dice:
        props.die(scene, seed, location=(x, y, 0), turn=turn)


def on_top(scene: bpy.types.Scene) -> None:
    """Lay things on the box."""
    height = BOX[2]
    props.book(scene, 21, (0.2, 0.14, 0.024), location=(0.165, 0.11, height + 0.012),
               rotation=(0, 0, -0.5))  # fmt: skip
    props.can(scene, 33, location=(-0.1, -0.045, height))
    for k, colour in enumerate(("#c0392b", "#2e6da4", "#e0a526")):
        props.pencil(scene, colour, location=(-0.02 + 0.02 * k, 0.0, height + 0.004),
                     turn=-0.9 + 0.2 * k)  # fmt: skip
    props.die(scene, 44, location=(-0.01, 0.1, height), turn=0.4)


def photograph(view: View, out: Path, *, preview: bool) -> None:
    """Render one view and write its picture and truth."""
    scene = studio.fresh_scene(*PICTURE, samples=24 if preview else 110, seed=4)
    table(scene)
    art = cv2.resize(cover(), (SIZE[0] * 4, SIZE[1] * 4), interpolation=cv2.INTER_AREA)
    side = props.lettered(np.random.default_rng(5), (1200, 220), "CORNER QUEST")
    prints = {
        "top": props.texture_file("cover", art),
        "front": props.texture_file("side", side),
        "right": props.texture_file("side", side),
        "left": props.texture_file("side", side),
    }
    card = materials.plain("card", materials.rgb("#26264a"), roughness=0.5)
    box = props.printed_box(
        scene, "box", BOX, prints, card, location=(*view.place, BOX[2] / 2),
        rotation=(0, 0, np.radians(view.turn)), coat=0.35, roughness=0.3,
    )  # fmt: skip
    if view.hidden:
        on_top(scene)
    studio.set_world(scene, (0.9, 0.95, 1.0), 0.35)
    power, colour = view.light
    studio.add_area_light(
        scene, (-1.1, 0.2, 1.3), (0, 0.1, 0), size=0.8, power=power, colour=colour
    )
    studio.add_area_light(
        scene, (0.35, 0.75, 0.75), (0.05, 0.05, 0), size=0.12, power=view.lamp,
        colour=(1, 0.86, 0.66),
    )  # fmt: skip
    studio.add_camera(scene, view.camera, view.target, lens=view.lens, f_stop=8)
    corners = studio.to_world(box, props.print_corners(BOX, "top"))
    edges = truth.project(scene, corners)
    H = truth.homography(SIZE, edges)
    print_object = scene.objects["box top"]
    seen = studio.mask(scene, print_object)
    whole = cv2.fillConvexPoly(np.zeros(seen.shape, np.uint8), np.rint(edges).astype(int), 1)
    picture = sensor.expose(
        studio.render(scene), seed=len(view.name), blur=0.5, electrons=view.noise, read_noise=9
    )
    sensor.save(out / view.name, picture)
    record = {
        "image": view.name,
        "size": PICTURE,
        "camera": truth.camera_record(scene),
        "objects": {
            "box": {
                "template": "box.png",
                "corners": truth.warp_points(H, truth.template_corners(SIZE)),
                "homography": H,
                "visible": round(float(seen.sum() / whole.sum()), 3),
            }
        },
    }
    truth.write(out / "truth" / f"{view.name.rsplit('.', 1)[0]}.json", record)


def main(out: Path, *, preview: bool) -> None:
    """Take all three photographs."""
    for view in VIEWS:
        photograph(view, out, preview=preview)
