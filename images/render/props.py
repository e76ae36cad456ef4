"""Things that lie about on tables and shelves: books with lettering, cans, pencils, dice."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import cv2
import materials
import matplotlib as mpl
import numpy as np
import studio
from PIL import Image, ImageDraw, ImageFont

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    Triple = Sequence[float]

FONTS = Path(mpl.get_data_path()) / "fonts" / "ttf"
FACES = ("DejaVuSans-Bold", "DejaVuSerif-Bold", "DejaVuSans", "DejaVuSerif-Italic")
FIRST = ("The", "A Short", "Modern", "Practical", "My", "Secret", "Great", "Field", "Applied")
SECOND = (
    *("Robots", "Gardens", "Maps", "Islands", "Algebra", "Bread", "Circuits", "Whales", "Comets"),
    *("Bridges", "Clocks", "Motors", "Rivers", "Poems", "Chess", "Optics", "Lenses", "Tea"),
)
PAPERS = ("#8c2f2b", "#2f4f6f", "#3f5f3a", "#caa24a", "#5b3a5f", "#d8cfb8", "#2b2b33", "#a85a2a")
INKS = ("#f4ecd8", "#f6d365", "#e8e8e8", "#f2f2f2", "#f4ecd8", "#3a2a20", "#c9a24b", "#fff3da")
FACE_QUADS = {  # corners TL, BL, BR, TR as seen from outside, in units of half the size
    "top": ((-1, 1, 1), (-1, -1, 1), (1, -1, 1), (1, 1, 1)),
    "front": ((-1, -1, 1), (-1, -1, -1), (1, -1, -1), (1, -1, 1)),
    "right": ((1, -1, 1), (1, -1, -1), (1, 1, -1), (1, 1, 1)),
    "left": ((-1, 1, 1), (-1, 1, -1), (-1, -1, -1), (-1, -1, 1)),
}
LIFT = 0.0003  # metres between a body and the print upon it
_FOLDER = tempfile.TemporaryDirectory(prefix="props-")


def texture_file(name: str, picture: NDArray[np.uint8]) -> Path:
    """Write a texture where Blender can load it; it lives as long as this process."""
    path = Path(_FOLDER.name) / f"{name}.png"
    cv2.imwrite(str(path), picture)
    return path


def title(rng: np.random.Generator) -> str:
    """Return a book's title."""
    return f"{rng.choice(FIRST)} {rng.choice(SECOND)}"


def lettered(rng: np.random.Generator, size: tuple[int, int], words: str) -> NDArray[np.uint8]:
    """Draw a book's cover or spine: lettering, rules and ornaments on coloured cloth.

    Parameters
    ----------
    rng : numpy.random.Generator
    size : (width, height)
        The lettering runs along the width.
    words : str

    Returns
    -------
    ndarray, shape (height, width, 3), uint8
        BGR.
    """
    width, height = size
    kind = int(rng.integers(len(PAPERS)))
    page = Image.new("RGB", size, PAPERS[kind])
    pen = ImageDraw.Draw(page)
    ink = INKS[kind]
    face = str(FONTS / f"{rng.choice(FACES)}.ttf")
    letters = height * float(rng.uniform(0.42, 0.58))
    font = ImageFont.truetype(face, max(8, int(letters)))
    while font.getlength(words) > 0.72 * width and font.size > 8:
        font = ImageFont.truetype(face, int(font.size * 0.94))
    pen.text((0.13 * width, height / 2), words, fill=ink, font=font, anchor="lm")
    for at in (0.03, 0.06, 0.09, 0.9):
        pen.rectangle((at * width, 0, at * width + max(2, 0.006 * width), height), fill=ink)
    small = ImageFont.truetype(
        str(FONTS / "DejaVuSans-Bold.ttf"), max(7, int(min(0.3 * height, 0.05 * width)))
    )
    mark = "".join(chr(c) for c in rng.integers(65, 91, 2))
    pen.text((0.955 * width, height / 2), mark, fill=ink, font=small, anchor="mm")
    picture = np.asarray(page)[..., ::-1].astype(np.int16)
    # Cloth is never of one colour.
    weave = cv2.GaussianBlur(rng.normal(0, 22, (height, width)), (0, 0), 0.8)
    return np.clip(picture + weave[..., None], 0, 255).astype(np.uint8)


def printed_box(
    scene: bpy.types.Scene,
    name: str,
    size: Triple,
    prints: Mapping[str, Path],
    body: bpy.types.Material,
    *,
    location: Triple,
    rotation: Triple = (0, 0, 0),
    coat: float = 0.25,
    roughness: float = 0.35,
) -> bpy.types.Object:
    """Add a cuboid with pictures on some of its faces; returns the body.

    Parameters
    ----------
    scene : bpy.types.Scene
    name : str
    size : sequence of 3 floats
        Metres.
    prints : mapping
        "top", "front", "right" or "left" to a picture file, upright as seen from outside.
    body : bpy.types.Material
    location, rotation : sequence of 3 floats
        Of the centre; XYZ Euler angles, radians.
    coat, roughness : float
        Of the prints.
    """
    box = studio.add_box(
        scene, name, size, body, location=location, rotation=rotation, bevel=0.0015
    )
    for face, path in prints.items():
        studio.add_mesh(
            scene,
            f"{name} {face}",
            print_corners(size, face),
            [(0, 1, 2, 3)],
            materials.picture(f"{name} {face}", path, roughness=roughness, coat=coat),
            uvs=[(0, 1), (0, 0), (1, 0), (1, 1)],
            smooth=False,
            location=location,
            rotation=rotation,
        )
    return box


def print_corners(size: Triple, face: str) -> NDArray[np.float64]:
    """Return a print's corners TL, BL, BR, TR in its box's own frame, shape (4, 3), metres."""
    half = np.asarray(size) / 2
    return np.array(FACE_QUADS[face]) * (half + LIFT)


def book(
    scene: bpy.types.Scene,
    seed: int,
    size: Triple,
    *,
    location: Triple,
    rotation: Triple = (0, 0, 0),
    words: str | None = None,
) -> None:
    """Add a lying book: spine to the front, cover on top.

    Parameters
    ----------
    scene : bpy.types.Scene
    seed : int
        Of its colours and title.
    size : sequence of 3 floats
        Length of the spine, width, thickness; metres.
    location, rotation : sequence of 3 floats
    words : str, optional
        Its title; drawn by the seed without it.
    """
    words = words or title(np.random.default_rng(seed))
    pixels = 2600  # per metre
    spine = lettered(
        np.random.default_rng(seed), (int(size[0] * pixels), int(size[2] * pixels)), words
    )
    cover = lettered(
        np.random.default_rng(seed), (int(size[0] * pixels), int(size[1] * pixels)), words
    )
    name = f"book {seed}"
    prints = {
        "front": texture_file(f"spine{seed}", spine),
        "top": texture_file(f"cover{seed}", cover),
    }
    body = materials.paper(f"pages {seed}", materials.rgb("#e9dfc6"))
    printed_box(
        scene, name, size, prints, body, location=location, rotation=rotation, coat=0.1,
        roughness=0.6,
    )  # fmt: skip


def cylinder(
    scene: bpy.types.Scene,
    name: str,
    radius: float,
    height: float,
    material: bpy.types.Material,
    *,
    location: Triple,
    rotation: Triple = (0, 0, 0),
    sides: int = 64,
    taper: float = 1.0,
) -> bpy.types.Object:
    """Add an upright cylinder on its foot, with u once round and v up.

    Parameters
    ----------
    scene : bpy.types.Scene
    name : str
    radius, height : float
        Metres.
    material : bpy.types.Material
    location, rotation : sequence of 3 floats
        Of the middle of the foot.
    sides : int
    taper : float
        Radius at the top over radius at the foot.
    """
    turn = np.linspace(0, 2 * np.pi, sides + 1)
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    low = np.column_stack([ring * radius, np.zeros(sides + 1)])
    high = np.column_stack([ring * radius * taper, np.full(sides + 1, height)])
    u = turn / (2 * np.pi)
    uvs = np.vstack([np.column_stack([u, 0 * u]), np.column_stack([u, 0 * u + 1])])
    faces: list[Sequence[int]] = [(i, i + 1, sides + 2 + i, sides + 1 + i) for i in range(sides)]
    thing = studio.add_mesh(
        scene, name, np.vstack([low, high]), faces, material, uvs=uvs,
        location=location, rotation=rotation,
    )  # fmt: skip
    lid = [list(range(sides))]
    metal = materials.plain(f"{name} lid", (0.62, 0.6, 0.56), roughness=0.35, metallic=0.4)
    studio.add_mesh(
        scene, f"{name} lid", high[:sides], lid, metal, smooth=False,
        location=location, rotation=rotation,
    )  # fmt: skip
    return thing


def can(scene: bpy.types.Scene, seed: int, *, location: Triple) -> None:
    """Add a tin with a printed label that repeats round it."""
    rng = np.random.default_rng(seed)
    words = f"{rng.choice(SECOND).upper()}  *  "
    label = lettered(rng, (520, 220), words)
    path = texture_file(f"label{seed}", np.hstack([label, label]))
    label_material = materials.picture(f"label {seed}", path, roughness=0.3, coat=0.3)
    cylinder(scene, f"can {seed}", 0.034, 0.1, label_material, location=location)


def pencil(scene: bpy.types.Scene, colour: str, *, location: Triple, turn: float) -> None:
    """Add a six-sided pencil that lies on the table; `turn` in radians about the vertical."""
    paint = materials.plain(f"pencil {colour}", materials.rgb(colour), roughness=0.25, coat=0.6)
    cylinder(
        scene, f"pencil {colour} {turn:.2f}", 0.004, 0.16, paint, location=location,
        rotation=(np.pi / 2, 0, turn), sides=6,
    )  # fmt: skip


def die(scene: bpy.types.Scene, seed: int, *, location: Triple, turn: float) -> None:
    """Add a white die of 18 mm with pips on the faces that a camera may see."""
    rng = np.random.default_rng(seed)
    prints = {}
    for face in FACE_QUADS:
        page = np.full((120, 120, 3), 236, np.uint8)
        pips = int(rng.integers(1, 7))
        spots = {
            1: [(60, 60)], 2: [(30, 30), (90, 90)], 3: [(30, 30), (60, 60), (90, 90)],
            4: [(30, 30), (30, 90), (90, 30), (90, 90)],
            5: [(30, 30), (30, 90), (90, 30), (90, 90), (60, 60)],
            6: [(30, 28), (30, 60), (30, 92), (90, 28), (90, 60), (90, 92)],
        }[pips]  # fmt: skip
        for spot in spots:
            cv2.circle(page, spot, 12, (30, 30, 30), -1, cv2.LINE_AA)
        prints[face] = texture_file(f"die{seed}{face}", page)
    body = materials.plain(f"die {seed}", (0.85, 0.85, 0.82), roughness=0.3, coat=0.5)
    place = (location[0], location[1], location[2] + 0.009)
    printed_box(
        scene, f"die {seed}", (0.018, 0.018, 0.018), prints, body, location=place,
        rotation=(0, 0, turn),
    )  # fmt: skip
