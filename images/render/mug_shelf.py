"""ROS2.png: the mug on a shelf among books. Exercise 4.1's scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import mug
import numpy as np
import props
import sensor
import shelf
import studio
import truth

if TYPE_CHECKING:
    from pathlib import Path

NAME, SIZE = "ROS2.png", (900, 600)
COVERS = 85, 75  # cream covers with dark bold letters


def main(out: Path, *, preview: bool) -> None:
    """Take the photograph."""
    scene = studio.fresh_scene(*SIZE, samples=20 if preview else 64, seed=3)
    # Three titles resemble the mug's: the best few matches mislead, a hundred do not.
    shelf.build(
        scene,
        7,
        covers={19: (COVERS[0], "The ROS developer"), 28: (COVERS[1], "ROS for developers")},
    )
    cup = mug.add_mug(scene, location=(0.07, -0.015, 0), yaw=9, handle=0.3)
    props.can(scene, 34, location=(-0.17, -0.02, 0))
    props.book(
        scene, COVERS[0], (0.14, 0.11, 0.034), location=(-0.06, 0.0, 0.017), rotation=(0, 0, 0.04),
        words="ROS developer",
    )  # fmt: skip
    props.die(scene, 45, location=(-0.07, -0.02, 0.034), turn=0.5)
    props.book(scene, 51, (0.17, 0.12, 0.022), location=(0.27, 0, 0.011), rotation=(0, 0, 0.12))
    props.book(scene, 52, (0.15, 0.11, 0.018), location=(0.27, 0.0, 0.031), rotation=(0, 0, -0.15))
    for k, colour in enumerate(("#c0392b", "#2e6da4", "#e0a526")):
        props.pencil(scene, colour, location=(-0.3 + 0.013 * k, -0.05, 0.004), turn=0.5 + 0.1 * k)
    shelf.light(scene, power=34)
    studio.add_camera(
        scene, (-0.01, -0.68, 0.16), (0.03, 0, 0.08), lens=51, roll=0.03, f_stop=9,
        focus=(0.07, -0.05, 0.05),
    )  # fmt: skip
    about = mug.record(scene, cup)
    template = np.array(truth_corners(out))
    # The print lies on a cylinder, so a homography between prints is an approximation.
    about["template"] = "ROS.png"
    about["homography_print"] = cv2.getPerspectiveTransform(
        template.astype(np.float32), about["print_corners"].astype(np.float32)
    )
    picture = sensor.expose(studio.render(scene), seed=40, blur=0.6, electrons=2000)
    sensor.save(out / NAME, picture)
    mug.write_truth(out, NAME, scene, about)


def truth_corners(out: Path) -> list[list[float]]:
    """Return the print's corners in the template's picture."""
    corners: list[list[float]] = truth.read(out / "truth" / "ROS.json")["objects"]["mug"][
        "print_corners"
    ]
    return corners
