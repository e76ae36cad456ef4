"""peppers.png: a still life of bell peppers and chillies on cloth. Examples 4.1 to 4.3."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import materials
import numpy as np
import sensor
import studio
import truth
from mathutils import Euler

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    Triple = Sequence[float]

NAME, SIZE = "peppers.png", (512, 512)
RED, DEEP_RED, GREEN, DARK_GREEN = "#b3140f", "#8c0d10", "#3f6d1c", "#234a14"
YELLOW, ORANGE, STEM = "#e2a60b", "#d2580c", "#56702a"


def grid_faces(rows: int, columns: int) -> list[tuple[int, int, int, int]]:
    """Return the quads of a closed tube of rows by columns vertices."""
    return [
        (
            r * columns + c,
            r * columns + (c + 1) % columns,
            (r + 1) * columns + (c + 1) % columns,
            (r + 1) * columns + c,
        )
        for r in range(rows - 1)
        for c in range(columns)
    ]


def bell(rng: np.random.Generator) -> tuple[NDArray[np.float64], list[tuple[int, int, int, int]]]:
    """Return a bell pepper of about 8 cm: lobes, a dimple at the stem, a puckered end."""
    rows, columns = 72, 120
    t = np.linspace(0, 1, rows)[:, None]  # from the stem's pit to the other end's pit
    angle = np.linspace(0, 2 * np.pi, columns, endpoint=False)[None, :]
    lobes = int(rng.choice([3, 4, 4]))
    phase = rng.uniform(0, 2 * np.pi)
    depth = rng.uniform(0.14, 0.2)
    # Radius along the profile: broad shoulders, narrower foot.
    radius = 0.040 * np.sin(np.pi * t) ** 0.5 * (1.12 - 0.34 * t)
    height = 0.046 * np.cos(np.pi * t) * (1 + 0.10 * np.cos(2 * np.pi * t))
    # Both ends fold inwards: the stem sits in a pit.
    height = height - 0.011 * np.exp(-((t / 0.17) ** 2)) + 0.012 * np.exp(-(((1 - t) / 0.12) ** 2))
    groove = np.abs(np.sin(0.5 * lobes * (angle + phase))) ** 0.55
    radius = radius * (1 - depth * (1 - groove) * (0.55 + 0.45 * t))
    for k in range(1, 4):
        wobble = rng.uniform(-0.025, 0.025) * np.cos(k * angle + rng.uniform(0, 6.3) + 2 * t)
        radius = radius * (1 + wobble)
    height = height - 0.004 * (1 - groove) * np.exp(-((t / 0.3) ** 2))
    height = height + 0.006 * (groove - 0.6) * np.exp(-(((1 - t) / 0.3) ** 2))
    lean = rng.uniform(-0.12, 0.12, 2)
    x = radius * np.cos(angle) + lean[0] * height
    y = radius * np.sin(angle) + lean[1] * height
    points = np.stack([x, y, height + 0 * angle], axis=-1).reshape(-1, 3)
    return points, grid_faces(rows, columns)


def tube(
    spine: NDArray[np.float64], radii: NDArray[np.float64], columns: int = 40
) -> tuple[NDArray[np.float64], list[tuple[int, int, int, int]]]:
    """Return a tube along a curve, shape (N, 3), with a radius at each of its points."""
    along = np.gradient(spine, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    side = np.cross(along, [0.13, 0.41, 0.9])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    other = np.cross(along, side)
    angle = np.linspace(0, 2 * np.pi, columns, endpoint=False)
    circle = (
        np.cos(angle)[None, :, None] * side[:, None] + np.sin(angle)[None, :, None] * other[:, None]
    )
    points = spine[:, None] + radii[:, None, None] * circle
    return points.reshape(-1, 3), grid_faces(len(spine), columns)


def chilli(rng: np.random.Generator) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return spine and radii of a chilli of about 11 cm, bent and tapering."""
    t = np.linspace(0, 1, 60)
    bend = rng.uniform(0.5, 1.3) * rng.choice([-1, 1])
    spine = np.column_stack(
        [0.11 * t, 0.03 * bend * t**2, 0.008 * np.sin(3 * t + rng.uniform(0, 6))]
    )
    radii = 0.0115 * np.minimum(1, (t / 0.05) ** 0.5) * (1 - t) ** 0.55 + 0.0006
    radii *= 1 + 0.05 * np.sin(14 * t + rng.uniform(0, 6))
    return spine, radii


def stem_curve(rng: np.random.Generator, length: float) -> NDArray[np.float64]:
    """Return a stem's curve upwards from the origin."""
    t = np.linspace(0, 1, 24)
    bend = rng.uniform(-0.45, 0.45, 2)
    return np.column_stack([bend[0] * length * t**2, bend[1] * length * t**2, length * t])


def skin(name: str, colour: str, blush: str) -> bpy.types.Material:
    """Return glossy skin: a little translucent, mottled, with fine pores and a waxy coat."""
    shader = materials.Shader(name)
    at = shader.coordinates()
    mottle = shader.noise(at, 38, detail=3)
    base = shader.ramp(mottle, [(0.34, materials.rgb(blush)), (0.6, materials.rgb(colour))])
    shader.set(
        base_color=base, roughness=0.24, coat_weight=0.85, coat_roughness=0.06,
        subsurface_weight=0.12, subsurface_radius=(0.006, 0.002, 0.001), subsurface_scale=1.0,
    )  # fmt: skip
    pores = shader.noise(at, 900, detail=2)
    waves = shader.noise(at, 70, detail=2)
    coarse = shader.bump(waves, strength=0.10, distance=0.0016)
    shader.bump(pores, strength=0.06, distance=0.0002, over=coarse)
    return shader.material


def stalk(name: str) -> bpy.types.Material:
    """Return the stem's ribbed, matt green."""
    shader = materials.Shader(name)
    fibres = shader.noise(shader.coordinates((420, 420, 60)), 1.0, detail=3)
    shader.set(
        base_color=shader.ramp(
            fibres, [(0.3, materials.rgb("#3c5420")), (0.7, materials.rgb("#86a04a"))]
        ),
        roughness=0.6,
    )
    shader.bump(fibres, strength=0.5, distance=0.0008)
    return shader.material


def add_bell(
    scene: bpy.types.Scene,
    seed: int,
    colour: str,
    blush: str,
    place: Triple,
    tilt: Triple,
    scale: float,
) -> None:
    """Add a bell pepper with its stem; `tilt` in degrees about x, y, z."""
    rng = np.random.default_rng(seed)
    points, faces = bell(rng)
    turn = Euler(np.radians(tilt)).to_matrix()
    where = {"location": place, "rotation": tuple(turn.to_euler())}
    studio.add_mesh(
        scene, f"bell {seed}", points * scale, faces, skin(f"skin {seed}", colour, blush), **where
    )
    green = stalk(f"stem {seed}")
    length = rng.uniform(0.026, 0.036)
    t = np.linspace(0, 1, 24)
    radii = 0.0042 + 0.0075 * np.exp(-((t / 0.10) ** 2)) + 0.0018 * np.exp(-(((1 - t) / 0.1) ** 2))
    radii[-1] = 0.0003
    spine = stem_curve(rng, length) + [0, 0, 0.031]
    points, faces = tube(spine, radii)
    ribs = np.arctan2(points[:, 1], points[:, 0])
    points[:, :2] *= (1 + 0.12 * np.cos(5 * ribs))[:, None]
    studio.add_mesh(scene, f"stem {seed}", points * scale, faces, green, **where)


def add_chilli(
    scene: bpy.types.Scene,
    seed: int,
    colour: str,
    blush: str,
    place: Triple,
    tilt: Triple,
    scale: float,
) -> None:
    """Add a chilli with its cap and stem; it lies along the turned x axis."""
    rng = np.random.default_rng(seed)
    where = {"location": place, "rotation": tuple(Euler(np.radians(tilt)))}
    spine, radii = chilli(rng)
    points, faces = tube(spine, radii, 48)
    studio.add_mesh(
        scene, f"chilli {seed}", points * scale, faces, skin(f"hot {seed}", colour, blush), **where
    )
    t = np.linspace(0, 1, 24)
    cap = np.column_stack([0.010 - 0.038 * t, 0.006 * t**2, 0.009 * t**2])
    thick = 0.0118 * np.exp(-((t / 0.22) ** 2)) + 0.0024
    thick[0], thick[-1] = 0.0123, 0.0003
    points, faces = tube(cap, thick, 32)
    studio.add_mesh(scene, f"cap {seed}", points * scale, faces, stalk(f"cap {seed}"), **where)


BELLS = (
    # seed, colour, blush, place, tilt, scale
    (1, RED, DEEP_RED, (-0.046, 0.040, 0.040), (34, -18, 30), 1.15),
    (2, GREEN, DARK_GREEN, (0.045, 0.046, 0.040), (36, 22, -40), 1.12),
    (3, YELLOW, ORANGE, (0.008, -0.030, 0.040), (66, 14, 10), 1.04),
    (4, DARK_GREEN, "#183a0f", (-0.083, -0.036, 0.036), (74, -40, 60), 1.02),
    (5, DEEP_RED, "#6e0a0c", (0.094, -0.022, 0.036), (60, 30, -70), 1.0),
    (6, ORANGE, RED, (0.118, 0.085, 0.036), (30, 10, 80), 1.0),
    (7, YELLOW, "#c98a08", (-0.122, 0.085, 0.034), (35, 5, -60), 1.04),
    (8, GREEN, "#2c5a15", (0.0, 0.122, 0.036), (28, -8, 20), 1.05),
    (9, RED, "#9c1010", (-0.016, -0.105, 0.034), (82, 0, 160), 0.95),
    (10, RED, DEEP_RED, (-0.085, 0.150, 0.034), (40, 10, 50), 0.95),
    (11, DARK_GREEN, "#183a0f", (0.092, 0.158, 0.034), (30, -20, 10), 0.95),
)
CHILLIES = (
    (21, RED, "#7c0a0a", (-0.105, -0.088, 0.016), (5, 0, 10), 1.1),
    (22, GREEN, "#2a5216", (0.028, -0.076, 0.020), (0, -6, -18), 1.1),
    (23, RED, DEEP_RED, (0.040, -0.108, 0.016), (10, 0, 12), 1.1),
    (24, ORANGE, RED, (-0.112, -0.118, 0.015), (0, 0, -8), 1.1),
    (25, YELLOW, ORANGE, (0.030, -0.138, 0.015), (0, 0, 8), 1.1),
    (26, DARK_GREEN, "#15330c", (-0.115, -0.148, 0.015), (0, 0, 6), 1.1),
)


def build(scene: bpy.types.Scene) -> None:
    """Lay out cloth and peppers."""
    side = np.linspace(-0.5, 0.5, 160)
    x, y = np.meshgrid(side, side)
    folds = 0.006 * np.sin(21 * x + 5 * y + 2 * np.sin(9 * y)) + 0.004 * np.sin(13 * y - 8 * x)
    points = np.stack([x, y, folds - 0.004 + 0 * x], axis=-1).reshape(-1, 3)
    n = len(side)
    faces = [(r * n + c, r * n + c + 1, (r + 1) * n + c + 1, (r + 1) * n + c)
             for r in range(n - 1) for c in range(n - 1)]  # fmt: skip
    studio.add_mesh(scene, "cloth", points, faces, materials.cloth("cloth", threads=520))
    for row in BELLS:
        add_bell(scene, *row)
    for row in CHILLIES:
        add_chilli(scene, *row)


def main(out: Path, *, preview: bool) -> None:
    """Take the photograph."""
    scene = studio.fresh_scene(*SIZE, samples=24 if preview else 140, seed=5, bounces=8)
    build(scene)
    studio.set_world(scene, (0.85, 0.9, 1.0), 0.22)
    studio.add_area_light(scene, (-0.55, 0.15, 0.6), (0, 0, 0.03), size=0.28, power=11)
    studio.add_area_light(
        scene, (0.5, 0.35, 0.45), (0, 0, 0.03), size=0.12, power=3.0, colour=(1, 0.86, 0.7)
    )
    studio.add_area_light(
        scene, (0.1, -0.6, 0.5), (0, 0, 0.03), size=0.35, power=2.2, colour=(0.85, 0.92, 1)
    )
    studio.add_camera(
        scene, (0.0, -0.30, 0.46), (0, 0.003, 0.03), lens=72, f_stop=9, focus=(0, -0.04, 0.05)
    )
    picture = sensor.expose(studio.render(scene), seed=21, blur=0.45, electrons=9000)
    sensor.save(out / NAME, picture)
    record = {"image": NAME, "size": SIZE, "camera": truth.camera_record(scene), "objects": {}}
    truth.write(out / "truth" / "peppers.json", record)
