"""What light and a camera do to a scene: exposure, dim light, noise, blur, compression."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib.scenes.resample import soften
from course_lib.scenes.texture import light

if TYPE_CHECKING:
    from course_lib._validate import Image


def exposed(picture: Image, gains: tuple[float, float, float]) -> Image:
    """
    Change exposure and white balance: each channel times its gain (B, G, R).

    The gains are rounded to 1 / 256, so that a table holds the result exactly.
    """
    tables = [
        np.minimum(np.arange(256) * round(gain * 256) // 256, 255).astype(np.uint8)
        for gain in gains
    ]
    return np.stack([tables[c][picture[..., c]] for c in range(3)], axis=2)


def small_change(picture: Image, rng: np.random.Generator) -> Image:
    """Return the picture as another camera on another day would give it."""
    level = rng.uniform(0.85, 1.12)
    warmth = rng.uniform(-0.06, 0.06)
    return exposed(picture, (level * (1 - warmth), level, level * (1 + warmth)))


def dimmed(picture: Image, rng: np.random.Generator) -> Image:
    """Return the picture in dim, warm, uneven light, with less contrast."""
    level = rng.uniform(0.42, 0.6)
    warmth = rng.uniform(0.12, 0.28)
    dark = exposed(picture, (level * (1 - warmth), level, level * (1 + warmth))).astype(np.int32)
    uneven = light(rng, picture.shape[0], picture.shape[1], 60)
    lifted = dark * uneven[..., None] // 256 + int(rng.integers(6, 18))
    return noisy(np.clip(lifted, 0, 255).astype(np.uint8), rng, 1.5)


def noisy(picture: Image, rng: np.random.Generator, sigma: float) -> Image:
    """Add a sensor's noise of ``sigma`` grey levels, rounded to whole levels."""
    noise = rng.standard_normal(picture.shape, dtype=np.float32)
    noise *= np.float32(sigma)
    summed = np.rint(noise, out=noise).astype(np.int16) + picture
    return np.asarray(np.clip(summed, 0, 255), np.uint8)


def bad_sensor(picture: Image, rng: np.random.Generator) -> Image:
    """Return the picture blurred, noisy and compressed."""
    blurred = soften(picture, int(rng.integers(1, 3)))
    grainy = noisy(blurred, rng, float(rng.uniform(5, 10)))
    quality = [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(40, 71))]
    _, data = cv2.imencode(".jpg", grainy, quality)
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR_BGR), np.uint8)
