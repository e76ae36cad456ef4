"""Held-out mugs in scenes: what the contract promises."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from course_lib import scenes

PRESENT = [kind for kind in scenes.KINDS if kind != "absent"]


@pytest.mark.parametrize("kind", scenes.KINDS)
def test_shapes_and_types(kind):
    made = scenes.mug_scene(11, kind=kind)
    assert made.kind == kind
    assert made.mug.shape == (600, 400, 3)
    assert made.scene.shape == (400, 600, 3)
    assert made.mug.dtype == made.scene.dtype == np.uint8
    if kind == "absent":
        assert made.corners is None
        assert made.homography is None
    else:
        assert made.corners.dtype == np.float32
        assert made.homography.dtype == np.float64


@pytest.mark.parametrize("kind", PRESENT)
def test_corners_are_the_mapped_rectangle(kind):
    for seed in range(8):
        made = scenes.mug_scene(seed, kind=kind)
        rectangle = np.float64([[[0, 0]], [[0, 599]], [[399, 599]], [[399, 0]]])
        mapped = cv2.perspectiveTransform(rectangle, made.homography)[:, 0]
        assert np.allclose(made.corners, mapped, atol=1e-3)
        assert (made.corners >= 2).all()
        assert (made.corners <= [597, 397]).all()


def test_kind_none_draws_every_kind_and_says_which():
    kinds = {seed: scenes.mug_scene(seed).kind for seed in range(40)}
    assert set(kinds.values()) == set(scenes.KINDS)
    same = scenes.mug_scene(3, kind=kinds[3])
    assert np.array_equal(scenes.mug_scene(3).scene, same.scene)


def test_wrong_arguments():
    with pytest.raises(ValueError, match="unknown kind 'upside down'; choose from plain"):
        scenes.mug_scene(0, kind="upside down")
    with pytest.raises(ValueError, match="seed must be at least 0"):
        scenes.mug_scene(-1)
