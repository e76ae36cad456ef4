"""A wooden shelf with books whose spines carry lettering, and other things."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import materials
import numpy as np
import props
import studio

if TYPE_CHECKING:
    from collections.abc import Mapping

    import bpy


def standing_book(
    scene: bpy.types.Scene,
    seed: int,
    x: float,
    *,
    y: float,
    lean: float = 0.0,
    cover: tuple[int, str] | None = None,
) -> float:
    """Stand a book on the board, its spine to the front; return its thickness.

    Parameters
    ----------
    scene : bpy.types.Scene
    seed : int
    x : float
        Of its left side, metres.
    y : float
        Of its spine.
    lean : float
        Radians to the left.
    cover : (seed, title), optional
        How it looks; `seed` decides without it.
    """
    rng = np.random.default_rng(seed)
    thick, tall = float(rng.uniform(0.016, 0.042)), float(rng.uniform(0.17, 0.235))
    depth = 0.14
    look, words = (np.random.default_rng(cover[0]), cover[1]) if cover else (rng, props.title(rng))
    spine = props.lettered(look, (int(tall * 3400), int(thick * 3400)), words)
    upright = cv2.rotate(spine, cv2.ROTATE_90_CLOCKWISE)
    body = materials.paper(f"pages {seed}", materials.rgb("#e6dcc4"))
    props.printed_box(
        scene, f"standing {seed}", (thick, depth, tall),
        {"front": props.texture_file(f"upright{seed}", upright)}, body,
        location=(x + thick / 2 - lean * tall / 2, y + depth / 2, tall / 2),
        rotation=(0, -lean, 0), coat=0.1, roughness=0.55,
    )  # fmt: skip
    return thick


def build(
    scene: bpy.types.Scene,
    seed: int,
    *,
    gap: tuple[float, float] | None = None,
    wide: float = 0.75,
    covers: Mapping[int, tuple[int, str]] | None = None,
) -> None:
    """Build a shelf: boards, back, a row of books, and things before them.

    Parameters
    ----------
    scene : bpy.types.Scene
    seed : int
        Of the books.
    gap : (from, to), optional
        Metres along x that the books leave free.
    wide : float
        The row reaches so far to either side.
    covers : mapping, optional
        A book's number in the row, from the left, to its cover: see `standing_book`.
    """
    rng = np.random.default_rng(seed)
    wood = materials.wood("shelf", rings=16, light=materials.rgb("#b98a55"))
    studio.add_box(scene, "board", (2.2, 0.34, 0.03), wood, location=(0, 0.1, -0.015), bevel=0.002)
    upper = materials.wood("upper shelf", rings=16, light=materials.rgb("#b98a55"))
    studio.add_box(scene, "upper", (2.2, 0.3, 0.03), upper, location=(0, 0.12, 0.315), bevel=0.002)
    back = materials.wood("back", rings=22, dark=materials.rgb("#6b4526"))
    studio.add_box(scene, "back", (2.2, 0.02, 0.9), back, location=(0, 0.27, 0.2))
    x, number = -wide, 0
    while x < wide:
        if gap and gap[0] - 0.03 < x < gap[1]:
            x = gap[1]
        lean = float(rng.choice([0, 0, 0, 0.06, -0.05]))
        x += 0.002 + abs(lean) * 0.2 + standing_book(
            scene, 100 * seed + number, x, y=0.06 + 0.02 * float(rng.random()), lean=lean,
            cover=(covers or {}).get(number),
        )  # fmt: skip
        number += 1


def light(scene: bpy.types.Scene, *, power: float = 16, warm: float = 1.0) -> None:
    """Light the shelf: a window from the left, a lamp from the right above, the room."""
    studio.set_world(scene, (0.9, 0.95, 1.0), 0.3)
    studio.add_area_light(
        scene, (-0.8, -1.0, 0.75), (0, 0, 0.1), size=0.5, power=power, colour=(1, 0.98, 0.95)
    )
    studio.add_area_light(
        scene, (0.7, -0.6, 0.6), (0.05, 0, 0.1), size=0.15, power=power * 0.25 * warm,
        colour=(1, 0.8, 0.58),
    )  # fmt: skip
