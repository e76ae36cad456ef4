"""Errors, credit and overlap of outlines."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_lib.grading.geometry import (
    corner_error,
    credit,
    expected_outline,
    mug_credit,
    outline_overlap,
    well_credit,
)
from course_lib.grading.thresholds import FORM, MUG, MUG_COVERED, WELL, Tolerance

SQUARE = np.float32([[10, 10], [10, 109], [109, 109], [109, 10]])
NO_OUTLINE = [
    None,
    "corners",
    b"corners",
    {"a": 1},
    [[1, 2], [3]],
    [["1", "2"]] * 4,
    np.zeros((4, 1, 2)),
    np.zeros((3, 2)),
    np.zeros((4, 2), complex),
    np.zeros((4, 2), bool),
    np.full((4, 2), np.nan),
    np.full((4, 2), -np.inf),
    np.full((4, 2), 1e300),
    np.full((4, 2), None),
    object(),
]


def test_error_is_the_root_mean_square_distance():
    found = SQUARE.copy()
    found[2] += (6, 8)
    assert corner_error(found, SQUARE) == pytest.approx(5)
    assert corner_error(SQUARE.astype(int).tolist(), SQUARE) == 0


@pytest.mark.parametrize("found", NO_OUTLINE)
def test_what_is_no_outline_is_infinitely_far(found):
    assert corner_error(found, SQUARE) == math.inf
    assert outline_overlap(found, SQUARE) == 0
    assert mug_credit(found, SQUARE) == well_credit(found, SQUARE) == 0


@given(st.floats(0, 1e4), st.floats(0, 1e4))
def test_credit_falls_and_stays_between_0_and_1(a, b):
    low, high = sorted((a, b))
    assert 0 <= credit(high, MUG) <= credit(low, MUG) <= 1


def test_credit_has_no_step():
    errors = np.linspace(0, 60, 6001)
    steps = np.diff([credit(error, MUG) for error in errors])
    assert np.abs(steps).max() < 0.002
    assert credit(MUG.full, MUG) == 1
    assert credit(math.sqrt(MUG.full * MUG.none), MUG) == pytest.approx(0.5)
    assert credit(MUG.none, MUG) == credit(math.inf, MUG) == credit(math.nan, MUG) == 0


def test_absence_is_right_only_as_none():
    assert mug_credit(None, None) == well_credit(None, None) == 1
    assert mug_credit(SQUARE, None) == well_credit(SQUARE, None) == 0
    assert mug_credit(np.full((4, 2), np.nan), None) == 0
    # What says the same in another form is worth what right corners in another form are.
    assert mug_credit([], None) == well_credit(np.zeros((4, 2)), None) == FORM


def test_a_covered_mug_is_allowed_more():
    found = SQUARE + (30, 0)
    assert mug_credit(found, SQUARE, "cover") == 1 > mug_credit(found, SQUARE, "plain") > 0
    assert MUG_COVERED.full > MUG.full


def test_overlap_of_shifted_squares():
    half = SQUARE + (49.5, 0)
    assert outline_overlap(half, SQUARE) == pytest.approx(1 / 3, abs=1e-3)
    assert outline_overlap(SQUARE, SQUARE) == pytest.approx(1)
    assert outline_overlap(SQUARE + (200, 0), SQUARE) == 0


@pytest.mark.parametrize(
    "order", [(1, 2, 3, 0), (2, 3, 0, 1), (3, 2, 1, 0), (0, 3, 2, 1), (0, 2, 1, 3)]
)
def test_overlap_asks_for_the_order(order):
    assert outline_overlap(SQUARE[list(order)], SQUARE) == 0


@given(st.floats(-80, 80), st.floats(0.3, 3), st.integers(0, 300), st.integers(0, 200))
def test_overlap_agrees_with_counted_pixels(degrees, scale, dx, dy):
    turn = math.radians(degrees)
    rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    found = (SQUARE - 59.5) @ rotation.T * scale + (dx, dy)
    grid = np.stack(np.meshgrid(np.arange(-160, 460, 2), np.arange(-160, 460, 2)), -1)
    masks = [inside(grid, each) for each in (found, SQUARE)]
    counted = (masks[0] & masks[1]).sum() / (masks[0] | masks[1]).sum()
    expected = counted if abs(degrees) < 45 else 0
    if abs(abs(degrees) - 45) > 1:
        assert outline_overlap(found, SQUARE) == pytest.approx(expected, abs=0.03)


def inside(grid, corners):
    result = np.ones(grid.shape[:2], bool)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        side, to = b - a, grid - a
        result &= side[0] * to[..., 1] - side[1] * to[..., 0] <= 0
    return result


@given(st.floats(0.4, 2.5), st.floats(0.4, 2.5), st.integers(-100, 300), st.integers(-100, 300))
def test_expected_outline_goes_along_with_the_silhouette(sx, sy, dx, dy):
    there = np.array([[20, 30], [60, 20], [80, 90], [30, 110], [22, 70]], float)
    here = there * (sx, sy) + (dx, dy)
    crop = (15, 25, 50, 80)
    outline = expected_outline(crop, there, here)
    rectangle = np.array([[15, 25], [15, 104], [64, 104], [64, 25]])
    assert np.allclose(outline, rectangle * (sx, sy) + (dx, dy))
    assert well_credit(outline, outline) == 1


def test_tolerances_are_in_order():
    for tolerance in (MUG, MUG_COVERED, WELL):
        assert isinstance(tolerance, Tolerance)
        assert 0 < tolerance.full < tolerance.none
