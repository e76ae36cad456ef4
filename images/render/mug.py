"""The mug: a lathe-turned body, a handle, and the transfer wrapped round its front.

The mug's own frame has its origin in the middle of its foot, z up, the print facing -y.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy
import cv2
import materials
import numpy as np
import props
import studio
import truth
from mug_print import ASPECT, draw_print

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    Triple = Sequence[float]

RADIUS, HEIGHT, WALL = 0.041, 0.096, 0.0035  # metres
PRINT_HEIGHT, PRINT_FOOT = 0.074, 0.011
ARC = PRINT_HEIGHT * ASPECT / RADIUS  # radians of the cylinder that the print covers
GRID = (5, 9)  # rows, columns of the truth's points on the print
GLAZE = 0.83  # linear reflectance of the white glaze


def print_points(u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points of the print in the mug's frame.

    Parameters
    ----------
    u, v : ndarray, shape (N,)
        0 to 1 from the print's left to its right and from its top to its foot.

    Returns
    -------
    ndarray, shape (N, 3)
        Metres.
    """
    angle = (u - 0.5) * ARC - np.pi / 2
    r = RADIUS + 0.00025
    z = PRINT_FOOT + PRINT_HEIGHT * (1 - v)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


def _body(scene: bpy.types.Scene, glaze: bpy.types.Material) -> bpy.types.Object:
    lip = [(RADIUS - WALL / 2 + WALL / 2 * np.cos(a), HEIGHT + WALL / 2 * np.sin(a))
           for a in np.linspace(0, np.pi, 7)]  # fmt: skip
    profile = [
        (0, 0.003), (RADIUS - 0.008, 0.002), (RADIUS - 0.006, 0), (RADIUS - 0.003, 0.0006),
        (RADIUS - 0.0006, 0.004), (RADIUS, 0.008), *lip, (RADIUS - WALL, 0.012),
        (RADIUS - WALL - 0.006, 0.007), (0, 0.006),
    ]  # fmt: skip
    turn = np.arange(96) * 2 * np.pi / 96
    around = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    points = np.array([[*(r * c), z] for r, z in profile for c in around])
    n = len(around)
    faces = [
        (i * n + k, i * n + (k + 1) % n, (i + 1) * n + (k + 1) % n, (i + 1) * n + k)
        for i in range(len(profile) - 1)
        for k in range(n)
    ]
    return studio.add_mesh(scene, "mug body", points, faces, glaze)


def _handle(scene: bpy.types.Scene, glaze: bpy.types.Material) -> bpy.types.Object:
    along = np.linspace(-0.62 * np.pi, 0.62 * np.pi, 40)
    centre = np.column_stack(
        [RADIUS + 0.006 + 0.024 * np.cos(along), 0 * along, 0.05 + 0.031 * np.sin(along)]
    )
    outward = np.column_stack([np.cos(along), 0 * along, np.sin(along)])
    turn = np.arange(16) * 2 * np.pi / 16
    rings = [
        c + 0.0045 * np.cos(t) * o + 0.0065 * np.sin(t) * np.array([0, 1, 0])
        for c, o in zip(centre, outward, strict=True)
        for t in turn
    ]
    faces = [
        (i * 16 + k, i * 16 + (k + 1) % 16, (i + 1) * 16 + (k + 1) % 16, (i + 1) * 16 + k)
        for i in range(len(centre) - 1)
        for k in range(16)
    ]
    return studio.add_mesh(scene, "mug handle", rings, faces, glaze)


def _transfer(scene: bpy.types.Scene) -> bpy.types.Object:
    art = draw_print(2048)[..., ::-1]
    # The paper is transparent on a real mug: its white is the glaze's.
    art = np.clip(art * GLAZE ** (1 / 2.2), 0, 255).astype(np.uint8)
    print_material = materials.picture(
        "mug print", props.texture_file("mug_print", art), roughness=0.12, coat=0.6
    )
    columns = 65
    u = np.repeat(np.linspace(0, 1, columns), 2)
    v = np.tile([0.0, 1.0], columns)
    faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(columns - 1)]
    uvs = np.column_stack([u, 1 - v])
    return studio.add_mesh(scene, "mug print", print_points(u, v), faces, print_material, uvs=uvs)


def add_mug(
    scene: bpy.types.Scene, *, location: Triple = (0, 0, 0), yaw: float = 0.0, handle: float = 0.6
) -> bpy.types.Object:
    """Add the mug; returns an empty that carries it.

    Parameters
    ----------
    scene : bpy.types.Scene
    location : sequence of 3 floats
        Of the middle of its foot, metres.
    yaw : float
        Degrees that the print is turned about the vertical, counter-clockwise seen from above.
    handle : float
        Where the handle sits, radians towards the back from the right.
    """
    glaze = materials.ceramic("glaze", (GLAZE, GLAZE, GLAZE * 0.985))
    mug = bpy.data.objects.new("mug", None)
    scene.collection.objects.link(mug)
    grip = _handle(scene, glaze)
    grip.rotation_euler = (0, 0, handle)
    for part in (_body(scene, glaze), grip, _transfer(scene)):
        part.parent = mug
    mug.location, mug.rotation_euler = location, (0, 0, np.radians(yaw))
    return mug


def record(scene: bpy.types.Scene, mug: bpy.types.Object) -> dict[str, Any]:
    """Return the mug's entry of the truth record, from the camera and from rendered masks.

    Parameters
    ----------
    scene : bpy.types.Scene
    mug : bpy.types.Object

    Returns
    -------
    dict
        `print_corners` (TL, BL, BR, TR), `print_grid` (rows, columns, 2), the mug's `outline`,
        and the share of the print that is `visible`: neither hidden nor turned away.
    """
    rows, columns = GRID
    v, u = (g.ravel() for g in np.mgrid[0 : 1 : rows * 1j, 0 : 1 : columns * 1j])
    world = studio.to_world(mug, print_points(u, v))
    grid = truth.project(scene, world).reshape(rows, columns, 2)
    parts = [scene.objects[name] for name in ("mug body", "mug handle", "mug print")]
    whole = np.clip(sum(studio.mask(scene, part) for part in parts), 0, 1)
    contours, _ = cv2.findContours(
        (whole > 0.5).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE
    )
    outline = cv2.approxPolyDP(max(contours, key=cv2.contourArea), 0.7, closed=True)
    seen = studio.mask(scene, parts[2]).sum()
    edge = np.vstack([grid[0], grid[1:, -1], grid[-1, -2::-1], grid[-2:0:-1, 0]])
    there = cv2.fillPoly(np.zeros(whole.shape, np.uint8), [np.rint(edge).astype(np.int32)], 1)
    return {
        "print_corners": grid[[0, -1, -1, 0], [0, 0, -1, -1]],
        "print_grid": grid,
        "outline": outline.reshape(-1, 2).astype(int),
        "visible": round(min(1.0, float(seen / max(1, there.sum()))), 3),
    }


def write_truth(out: Path, name: str, scene: bpy.types.Scene, mug: dict[str, Any]) -> None:
    """Write the truth of a picture of the mug.

    Parameters
    ----------
    out : Path
        The picture's folder.
    name : str
        File name of the picture.
    scene : bpy.types.Scene
    mug : dict
        As `record` returns it.
    """
    size = (scene.render.resolution_x, scene.render.resolution_y)
    about = {"image": name, "size": size, "camera": truth.camera_record(scene)}
    truth.write(out / "truth" / f"{name.rsplit('.', 1)[0]}.json", about | {"objects": {"mug": mug}})
