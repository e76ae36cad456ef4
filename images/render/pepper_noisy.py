"""pepper_noisy.jpg: the peppers, pixel for pixel, seen by a bad sensor. Example 4.2."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import sensor
import truth

if TYPE_CHECKING:
    from pathlib import Path

NAME = "pepper_noisy.jpg"
AFTER = "peppers"


def main(out: Path, *, preview: bool) -> None:  # noqa: ARG001 - a preview takes no longer
    """Spoil the photograph: little light, strong noise, hot pixels, compression."""
    clean = cv2.imread(str(out / "peppers.png"))
    if clean is None:
        raise FileNotFoundError(f"{out / 'peppers.png'} is missing: render peppers first")
    seen = sensor.expose(
        clean, seed=22, light=0.9, vignetting=0.3, blur=0.3, electrons=170, read_noise=6,
        hot_pixels=0.004,
    )  # fmt: skip
    sensor.save(out / NAME, seen, quality=88)
    about = truth.read(out / "truth" / "peppers.json")
    truth.write(out / "truth" / "pepper_noisy.json", about | {"image": NAME})
