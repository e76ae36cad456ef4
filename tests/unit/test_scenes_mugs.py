"""Held-out mugs in scenes: what the contract promises, and that the truth is the pixels'."""

from __future__ import annotations

import os
import subprocess
import sys

import cv2
import numpy as np
import pytest

from course_lib import images, scenes
from course_lib.scenes import heldout, mugs

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


def alike(made, H):
    """How the mug's print agrees: typical shift, template pixels, and the share of tiles found.

    The scene is brought back by H, and tiles of the template are looked for around their places.
    """
    back = cv2.warpPerspective(
        made.scene, H, (400, 600), flags=cv2.WARP_INVERSE_MAP | cv2.INTER_CUBIC
    )
    back, flat = (
        cv2.GaussianBlur(cv2.cvtColor(each, cv2.COLOR_BGR2GRAY), (0, 0), 1.5)
        for each in (back, made.mug)
    )
    reach, side, shifts, tiles = 8, 48, [], 0
    for top in range(100, 500, 24):
        for left in range(60, 300, 24):
            tile = flat[top : top + side, left : left + side]
            around = back[top - reach : top + side + reach, left - reach : left + side + reach]
            # Structure in both directions, as lettering has and the mug's outline has not.
            if cv2.cornerMinEigenVal(tile, side).max() < 2e-4:
                continue
            tiles += 1
            scores = cv2.matchTemplate(around, tile, cv2.TM_CCOEFF_NORMED)
            _, best, _, (x, y) = cv2.minMaxLoc(scores)
            if best > 0.8 and 0 < x < 2 * reach and 0 < y < 2 * reach:
                shifts.append(
                    (
                        x + vertex(scores[y, x - 1 : x + 2]) - reach,
                        y + vertex(scores[y - 1 : y + 2, x]) - reach,
                    )
                )
    shift = np.linalg.norm(np.median(shifts, axis=0)) if shifts else np.inf
    return float(shift), len(shifts) / tiles


def agrees(made, H):
    shift, share = alike(made, H)
    return shift < 0.1 and share > 0.4


def vertex(values):
    """Where the parabola through three samples is highest, from the middle one."""
    left, middle, right = (float(value) for value in values)
    return (left - right) / (2 * (left - 2 * middle + right))


@pytest.mark.parametrize("kind", PRESENT)
def test_truth_is_where_the_pixels_are(kind):
    mirror = np.array([[-1, 0, 399], [0, 1, 0], [0, 0, 1.0]])
    for seed in range(4):
        made = scenes.mug_scene(seed, kind=kind)
        assert agrees(made, made.homography), alike(made, made.homography)
        for dx, dy in ((2, 0), (0, -2)):
            shift = np.array([[1, 0, dx], [0, 1, dy], [0, 0, 1.0]])
            assert not agrees(made, shift @ made.homography)
        assert not agrees(made, made.homography @ mirror)


@pytest.mark.parametrize("kind", scenes.KINDS)
def test_only_the_cut_out_is_put_into_the_scene(kind, monkeypatch):
    """Two templates that differ in their backdrop alone give the same scene."""
    before = mugs._make(5, kind)
    monkeypatch.setattr(mugs.texture, "backdrop", plain_backdrop(mugs.texture.backdrop))
    after = mugs._make(5, kind)
    assert np.array_equal(before.scene, after.scene)
    differ = (before.mug != after.mug).any(axis=2).mean()
    assert 0.3 < differ < 0.8


def plain_backdrop(original):
    def backdrop(kind, rng, avoid):
        picture = original(kind, rng, avoid)  # the same draws
        return 255 - picture

    return backdrop


@pytest.mark.parametrize("seed", range(20))
def test_a_covered_mug_is_covered_by_a_fifth_to_a_half(seed):
    assert 0.2 <= scenes.mug_scene(seed, kind="cover").hidden <= 0.45


def test_the_mug_fills_the_template():
    heights = []
    for seed in range(24):
        rng = np.random.default_rng(seed)
        number = seed % heldout.N_MUGS
        _, top, _, bottom = heldout.mug_box(number)
        heights.append(mugs._placed(number, rng)[1, 1] * (bottom - top) / 600)
    assert min(heights) > 0.5
    assert 0.6 < np.median(heights) < max(heights) < 0.85


def test_absent_shows_no_mug_or_another(monkeypatch):
    """About half each; the template's own cut-out is never put into the scene."""
    put, original = [], mugs._put
    monkeypatch.setattr(
        mugs, "_put", lambda *of: (put.append((of[0].shape, of[1])), original(*of))[1]
    )
    for seed in range(24):
        mugs._make(seed, "absent")
    templates = [canvas for shape, canvas in put if shape == (600, 400, 3)]
    others = [canvas for shape, canvas in put if shape == (400, 600, 3)]
    assert len(templates) == 24
    assert 6 <= len(others) <= 18
    assert not set(map(id, templates)) & set(map(id, others))


def test_results_are_shared_and_read_only():
    made = scenes.mug_scene(2, kind="plain")
    assert scenes.mug_scene(2, kind="plain") is made
    for array in (made.mug, made.scene, made.corners, made.homography):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


DIGEST = """
import hashlib
from course_lib import scenes
digest = hashlib.sha256()
for kind in scenes.KINDS:
    made = scenes.mug_scene(7, kind=kind)
    digest.update(made.mug.tobytes() + made.scene.tobytes())
    if made.corners is not None:
        digest.update(made.corners.tobytes())
for frame in scenes.flight(7, n_frames=6).frames + scenes.yard_without_well(7, n_frames=2):
    digest.update(frame.image.tobytes())
print(digest.hexdigest())
"""


def test_same_seed_same_pixels_in_another_process_on_plainer_hardware():
    """Without vector instructions, and with another order of hashing."""
    digests = []
    for change in (
        {},
        {
            "PYTHONHASHSEED": "7",
            "NPY_DISABLE_CPU_FEATURES": "AVX2 FMA3",
            "OPENCV_CPU_DISABLE": "AVX2",
        },
    ):
        done = subprocess.run(
            [sys.executable, "-c", DIGEST],
            capture_output=True, text=True, check=True, env={**os.environ, **change},
        )  # fmt: skip
        digests.append(done.stdout.strip())
    assert digests[0] == digests[1]
    assert len(digests[0]) == 64


def test_missing_pictures_are_named(tmp_path, monkeypatch):
    monkeypatch.setenv(images.FOLDER_VARIABLE, str(tmp_path))
    heldout.mug_cut_out.cache_clear()
    heldout.mug_box.cache_clear()
    with pytest.raises(scenes.MissingHeldOutError, match="not with the students' bundle"):
        scenes.mug_scene(987_654)
