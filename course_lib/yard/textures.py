"""Procedural textures of the yard: seeded numpy pictures, BGR uint8, that tile in both directions.

Every texture is a function of a seed and draws on a torus, so that a wall can repeat it without a
seam. Nothing here knows a renderer; Blender and a simulator can both use the arrays.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]


def wrapped_noise(
    shape: tuple[int, int], sigma: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Smooth noise on a torus, standard deviation 1.

    Parameters
    ----------
    shape : (height, width)
    sigma : float
        Correlation length in texels.
    rng : numpy Generator

    Returns
    -------
    noise : float64 (height, width)
    """
    spectrum = np.fft.rfft2(rng.standard_normal(shape))
    fy = np.fft.fftfreq(shape[0])[:, None]
    fx = np.fft.rfftfreq(shape[1])[None, :]
    noise = np.fft.irfft2(spectrum * np.exp(-2 * (np.pi * sigma) ** 2 * (fx**2 + fy**2)), s=shape)
    return np.asarray(noise / noise.std(), np.float64)


def _shade(base: tuple[float, float, float], tone: NDArray[np.float64]) -> Picture:
    """Multiply a BGR colour by a tone map (1 = unchanged)."""
    shaded = np.clip(np.array(base) * tone[..., None], 0, 255)
    return np.asarray(shaded, np.uint8)


def _cells(
    shape: tuple[int, int], seeds: NDArray[np.float64]
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Voronoi cells on a torus: index of the nearest seed, and F2 - F1 (small at the joints)."""
    h, w = shape
    y, x = np.arange(h)[:, None], np.arange(w)
    nearest = np.full(shape, np.inf)
    second = np.full(shape, np.inf)
    index = np.zeros(shape, np.int32)
    for k, (sx, sy) in enumerate(seeds):
        dx = np.abs(x - sx)
        dy = np.abs(y - sy)
        d = np.hypot(np.minimum(dx, w - dx), np.minimum(dy, h - dy))
        closer = d < nearest
        second = np.where(closer, nearest, np.minimum(second, d))
        index = np.where(closer, k, index)
        nearest = np.where(closer, d, nearest)
    return index, second - nearest


def _stones(
    shape: tuple[int, int],
    grid: tuple[int, int],
    base: tuple[float, float, float],
    rng: np.random.Generator,
    *,
    spread: float,
    mortar: float,
) -> Picture:
    """Rows of irregular stones in mortar: ``grid`` across and up, tones within ``spread``."""
    h, w = shape
    nx, ny = grid
    gx, gy = np.meshgrid(np.arange(nx), np.arange(ny))
    jitter = rng.uniform(-0.27, 0.27, (ny, nx, 2))
    sx = (gx + 0.5 * (gy % 2) + 0.5 + jitter[..., 0]) * w / nx
    sy = (gy + 0.5 + 0.7 * jitter[..., 1]) * h / ny
    index, joint = _cells(shape, np.stack([sx.ravel() % w, sy.ravel() % h], axis=1))
    tone = rng.uniform(1 - spread, 1 + spread, nx * ny)[index]
    edge = np.clip((joint - 3) / 6, 0, 1)
    tone = tone * (mortar + (1 - mortar) * edge)
    tone = tone * (1 + 0.05 * wrapped_noise(shape, 6, rng) + 0.035 * wrapped_noise(shape, 1.5, rng))
    return _shade(base, tone)


def stone(seed: int = 1) -> Picture:
    """Rubble of the well's wall: 1024 wide (once around) × 192 high."""
    rng = np.random.default_rng(seed)
    return _stones((192, 1024), (20, 5), (150, 163, 170), rng, spread=0.24, mortar=0.55)


def slab(seed: int = 2) -> Picture:
    """Pale dressed stone of the rim."""
    rng = np.random.default_rng(seed)
    return _stones((64, 512), (9, 1), (178, 192, 198), rng, spread=0.1, mortar=0.65)


def paving(seed: int = 3) -> Picture:
    """Flagstones of the path."""
    rng = np.random.default_rng(seed)
    return _stones((512, 512), (5, 5), (140, 158, 172), rng, spread=0.13, mortar=0.62)


def brick(seed: int = 4) -> Picture:
    """Running-bond bricks, 8 across and 16 up per tile: the repeated structure of the scene."""
    rng = np.random.default_rng(seed)
    h = w = 512
    picture = np.empty((h, w, 3), np.uint8)
    picture[:] = (168, 184, 192)
    bh, bw = h // 16, w // 8
    for row in range(16):
        for column in range(8):
            colour = np.array((88, 112, 186)) * rng.uniform(0.86, 1.12)
            x0 = column * bw + (bw // 2 if row % 2 else 0)
            for shift in (0, -w):
                top_left = (x0 + 3 + shift, row * bh + 3)
                bottom_right = (x0 + bw - 3 + shift, row * bh + bh - 3)
                cv2.rectangle(picture, top_left, bottom_right, colour.tolist(), -1)
    tone = 1 + 0.04 * wrapped_noise((h, w), 20, rng) + 0.03 * wrapped_noise((h, w), 1.2, rng)
    return np.clip(picture * tone[..., None], 0, 255).astype(np.uint8)


def grass(seed: int = 5) -> Picture:
    """Draw a lawn seen from above: patches of light and dark with short strokes."""
    rng = np.random.default_rng(seed)
    shape = (1024, 1024)
    tone = 1 + 0.09 * wrapped_noise(shape, 60, rng) + 0.06 * wrapped_noise(shape, 14, rng)
    picture = _shade((62, 150, 108), tone)
    for _ in range(9000):
        x, y = rng.integers(0, 1024, 2)
        dx, dy = rng.integers(-6, 7), -rng.integers(3, 11)
        colour = (np.array((60, 152, 112)) * rng.uniform(0.78, 1.22)).tolist()
        for sx in (0, -1024):
            for sy in (0, 1024):
                if x + sx < -20 or y + sy > 1044:
                    continue  # out of the picture
                start = (int(x + sx), int(y + sy))
                end = (int(x + sx + dx), int(y + sy + dy))
                cv2.line(picture, start, end, colour, 2, cv2.LINE_AA)
    return picture


def leaves(seed: int = 6) -> Picture:
    """Foliage of hedges and trees: overlapping rounded leaves."""
    rng = np.random.default_rng(seed)
    picture = np.empty((256, 256, 3), np.uint8)
    picture[:] = (38, 92, 48)
    for _ in range(700):
        x, y = rng.integers(0, 256, 2)
        colour = (np.array((58, 140, 82)) * rng.uniform(0.72, 1.25)).tolist()
        angle = float(rng.uniform(0, 180))
        for sx in (-256, 0, 256):
            for sy in (-256, 0, 256):
                centre = (int(x + sx), int(y + sy))
                cv2.ellipse(picture, centre, (9, 5), angle, 0, 360, colour, -1, cv2.LINE_AA)
    return picture


def wood(seed: int = 7) -> Picture:
    """Boards with grain along u, four boards per tile."""
    rng = np.random.default_rng(seed)
    shape = (256, 256)
    fine = rng.standard_normal(shape)
    spectrum = np.fft.rfft2(fine)
    fy = np.fft.fftfreq(256)[:, None]
    fx = np.fft.rfftfreq(256)[None, :]
    spectrum = spectrum * np.exp(-2 * np.pi**2 * ((40 * fx) ** 2 + (1.4 * fy) ** 2))
    grain = np.fft.irfft2(spectrum, s=shape)
    tone = 1 + 0.1 * grain / grain.std()
    for board in range(4):
        tone[board * 64 : board * 64 + 64] *= rng.uniform(0.88, 1.1)
        tone[board * 64 : board * 64 + 3] *= 0.5
    return _shade((86, 132, 176), tone)


def tiles(seed: int = 8) -> Picture:
    """Roof tiles: staggered rows, each tile darker under the edge of the one above."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0:256, 0:256]
    row = y // 32
    shifted = (x + 16 * (row % 2)) % 256
    tone = rng.uniform(0.86, 1.1, (8, 8))[row, shifted // 32]
    tone = tone * np.where(y % 32 < 5, 0.6, 1.0) * np.where(shifted % 32 < 2, 0.72, 1.0)
    tone = tone * (1 + 0.03 * wrapped_noise((256, 256), 3, rng))
    return _shade((72, 92, 196), tone)


def plaster(seed: int = 9) -> Picture:
    """Cream plaster with faint stains."""
    rng = np.random.default_rng(seed)
    shape = (256, 256)
    tone = 1 + 0.02 * wrapped_noise(shape, 30, rng) + 0.015 * wrapped_noise(shape, 2, rng)
    return _shade((186, 216, 230), tone)


def window(seed: int = 10) -> Picture:
    """Draw a window: white frame, four panes that mirror the sky, curtains."""
    rng = np.random.default_rng(seed)
    picture = np.empty((256, 224, 3), np.uint8)
    picture[:] = (232, 236, 238)
    for x0, x1 in ((16, 106), (118, 208)):
        for y0, y1 in ((16, 122), (134, 240)):
            fade = np.linspace(1.15, 0.75, y1 - y0)[:, None, None]
            pane = np.array((150, 122, 88)) * fade * np.ones((1, x1 - x0, 1))
            picture[y0:y1, x0:x1] = np.clip(pane, 0, 255)
    for side in (-1, 1):
        x = 112 + side * 90
        curtain = np.array([[x, 18], [x - side * 60, 18], [x - side * 12, 236], [x, 236]], np.int32)
        cv2.fillConvexPoly(picture, curtain, (205, 214, 232), cv2.LINE_AA)
    cv2.rectangle(picture, (106, 8), (118, 248), (232, 236, 238), -1)
    cv2.rectangle(picture, (8, 122), (216, 134), (232, 236, 238), -1)
    noise = rng.normal(0, 1.5, picture.shape)
    return np.clip(picture + noise, 0, 255).astype(np.uint8)


def door(seed: int = 11) -> Picture:
    """Draw a green panelled door with a brass knob."""
    rng = np.random.default_rng(seed)
    picture = _shade((92, 110, 46), 1 + 0.03 * wrapped_noise((384, 192), 3, rng))
    for x0 in (26, 106):
        for y0, y1 in ((24, 130), (150, 256), (276, 362)):
            cv2.rectangle(picture, (x0, y0), (x0 + 60, y1), (70, 86, 34), -1)
            cv2.rectangle(picture, (x0, y0), (x0 + 60, y1), (122, 140, 70), 2)
    cv2.circle(picture, (172, 204), 8, (70, 180, 220), -1, cv2.LINE_AA)
    return picture


ALL = {
    "stone": stone,
    "slab": slab,
    "paving": paving,
    "brick": brick,
    "grass": grass,
    "leaves": leaves,
    "wood": wood,
    "tiles": tiles,
    "plaster": plaster,
    "window": window,
    "door": door,
}


def make_all() -> dict[str, Picture]:
    """Every texture by name, BGR uint8, row 0 at the top (v = 1)."""
    return {name: make() for name, make in ALL.items()}
