"""Warping in whole numbers: against the definition in floating point, and against OpenCV."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from course_lib.scenes.resample import Canvas, blend, enlarge, opaque, premultiplied, soften

RNG = np.random.default_rng(0)
H = np.array([[0.72, -0.31, 70.3], [0.28, 0.66, 12.7], [2e-4, -3e-4, 1]])
BOX = (3, 5, 130, 111)


def smooth_picture(height=120, width=150):
    noise = RNG.integers(0, 256, (height // 6, width // 6, 4), dtype=np.uint8)
    return cv2.resize(noise, (width, height), interpolation=cv2.INTER_CUBIC)


def sampled(picture, x, y):
    """Bilinear interpolation in floating point, zero outside."""
    whole = np.pad(picture.astype(float), ((1, 1), (1, 1), (0, 0)))
    x, y = np.clip(x, -1, picture.shape[1]) + 1, np.clip(y, -1, picture.shape[0]) + 1
    column = np.minimum(np.floor(x).astype(int), whole.shape[1] - 2)
    row = np.minimum(np.floor(y).astype(int), whole.shape[0] - 2)
    fx, fy = (x - column)[..., None], (y - row)[..., None]
    top = whole[row, column] * (1 - fx) + whole[row, column + 1] * fx
    bottom = whole[row + 1, column] * (1 - fx) + whole[row + 1, column + 1] * fx
    return top * (1 - fy) + bottom * fy


def defined(picture, samples):
    left, top, right, bottom = BOX
    offsets = [0] if samples == 1 else [-0.25, 0.25]
    total = 0
    for dy in offsets:
        for dx in offsets:
            x, y = np.meshgrid(np.arange(left, right) + dx, np.arange(top, bottom) + dy)
            there = np.stack([x, y, np.ones_like(x)], -1) @ np.linalg.inv(H).T
            total = total + sampled(
                picture, there[..., 0] / there[..., 2], there[..., 1] / there[..., 2]
            )
    return total / len(offsets) ** 2


@pytest.mark.parametrize("samples", [1, 2])
def test_warp_is_what_it_says(samples):
    picture = smooth_picture()
    warped = Canvas(picture).warp(H, BOX, samples)
    error = np.abs(warped - defined(picture, samples))
    # Positions are rounded to 1 / 16 pixel: a few levels where the picture is steep.
    assert error.mean() < 0.6
    assert error.max() < 8
    bias = (warped - defined(picture, samples)).mean()
    assert abs(bias) < 0.3


def test_warp_agrees_with_opencv():
    picture = smooth_picture()
    theirs = cv2.warpPerspective(picture, H, (BOX[2], BOX[3]))[BOX[1] :, BOX[0] :]
    ours = Canvas(picture).warp(H, BOX, 1)
    assert np.abs(ours.astype(int) - theirs).mean() < 1.2


def test_identity_keeps_every_pixel():
    picture = smooth_picture()
    assert np.array_equal(Canvas(picture).warp(np.eye(3), (0, 0, 150, 120), 1), picture)


def test_strips_meet():
    picture = smooth_picture()
    whole = Canvas(picture).warp(H, (0, 0, 140, 120))
    parts = [Canvas(picture).warp(H, (0, row, 140, row + 7)) for row in range(0, 119, 7)]
    assert np.array_equal(np.concatenate(parts)[:119], whole[:119])


def test_blend_leaves_what_is_not_covered():
    under = RNG.integers(0, 256, (40, 50, 3), dtype=np.uint8)
    over = premultiplied(RNG.integers(0, 256, (20, 20, 4), dtype=np.uint8))
    over[:10] = 0
    over[10:, :10] = 255
    before = under.copy()
    blend(under, over, (5, 8, 25, 28))
    assert np.array_equal(under[8:18, 5:25], before[8:18, 5:25])
    assert (under[18:28, 5:15] == 255).all()
    weight = over[10:, 10:, 3:] / 255
    expected = over[10:, 10:, :3] + before[18:28, 15:25] * (1 - weight)
    assert np.abs(under[18:28, 15:25] - np.minimum(expected, 255)).max() <= 1
    under[8:28, 5:25] = before[8:28, 5:25]
    assert np.array_equal(under, before)


def test_opaque_and_soften():
    picture = smooth_picture()[..., :3].copy()
    assert (opaque(picture)[..., 3] == 255).all()
    flat = np.full((9, 9, 3), 77, np.uint8)
    assert np.array_equal(soften(flat, 3), flat)
    spike = np.zeros((9, 9), np.uint8)
    spike[4, 4] = 160
    expected = [[10, 20, 10], [20, 40, 20], [10, 20, 10]]
    assert soften(spike, 1)[3:6, 3:6].tolist() == expected


def test_enlarge_meets_the_samples():
    coarse = RNG.integers(-300, 300, (4, 6))
    grown = enlarge(coarse, 31, 51)
    assert np.array_equal(grown[::10, ::10], coarse)
    assert np.abs(np.diff(grown, axis=1)).max() <= 61
