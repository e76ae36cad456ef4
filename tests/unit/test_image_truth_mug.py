"""The mug pictures' truth agrees with their pixels; a wrong camera convention cannot pass.

Each picture's print is unrolled with the truth's grid and laid upon the drawing that was printed.
"""

from __future__ import annotations

import runpy
from collections.abc import Callable
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest

from course_lib import images

PICTURES = ["ROS.png", "ROS2.png", *(f"heldout/mug_{number}.png" for number in range(1, 7))]
CUT_OUT = PICTURES[2:]
BACKGROUNDS = [name for name in images.names("heldout") if "background" in name]
# The mug as images/render/mug.py builds it, metres: the transfer lies a hair above the glaze.
RADIUS, TRANSFER, PRINT_HEIGHT, PRINT_FOOT = 0.041, 0.00025, 0.074, 0.011
RENDER = Path(__file__).parents[2] / "images" / "render"
TILES = (4, 7)
REACH = 6


def mug(name: str) -> dict[str, np.ndarray]:
    return images.truth(name)["objects"]["mug"]


@cache
def drawing() -> tuple[np.ndarray, float]:
    """The flat print (BGR) and its width over its height."""
    script = runpy.run_path(str(RENDER / "mug_print.py"))
    return script["draw_print"](1024)[..., ::-1].copy(), script["ASPECT"]


def on_grid(values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Weights (len(at), len(values)) of the polynomial through equally spaced samples."""
    powers = np.arange(len(values))
    return (2 * at[:, None] - 1) ** powers @ np.linalg.inv((2 * values[:, None] - 1) ** powers)


def unroll(name: str, grid: np.ndarray) -> np.ndarray:
    """The picture's print, flat, with about as many pixels as the picture has there."""
    aspect = drawing()[1]
    height = int(np.linalg.norm(grid[-1, 4] - grid[0, 4]))
    width = int(height * aspect)
    rows, columns = grid.shape[:2]
    v = on_grid(np.linspace(0, 1, rows), (np.arange(height) + 0.5) / height)
    u = on_grid(np.linspace(0, 1, columns), (np.arange(width) + 0.5) / width)
    x, y = (np.float32(v @ grid[..., axis] @ u.T) for axis in (0, 1))
    return cv2.remap(images.load(name), x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)


def peak(scores: np.ndarray) -> tuple[np.ndarray, float]:
    """Place (x, y) of the highest score, to a fraction of a pixel, and that score."""
    _, best, _, (x, y) = cv2.minMaxLoc(scores)
    place = np.array([x, y], float)
    for axis, (line, at) in enumerate(((scores[y], x), (scores[:, x], y))):
        if 0 < at < len(line) - 1:
            left, middle, right = (float(line[at + step]) for step in (-1, 0, 1))
            place[axis] += (left - right) / (2 * (left - 2 * middle + right))
    return place, best


def misfit(name: str, grid: np.ndarray) -> tuple[float, float]:
    """Typical shift of the drawing's tiles upon the unrolled print, pixels, and correlation.

    Tiles near the ends of the print are turned away from the camera and left out.
    """
    seen = cv2.cvtColor(unroll(name, grid), cv2.COLOR_BGR2GRAY)
    height, width = seen.shape
    flat = cv2.resize(drawing()[0], (width, height), interpolation=cv2.INTER_AREA)
    flat = cv2.GaussianBlur(cv2.cvtColor(flat, cv2.COLOR_BGR2GRAY), (0, 0), 0.8)
    shifts, scores = [], []
    for top in np.linspace(REACH, height - REACH, TILES[0] + 1)[:-1].astype(int):
        for left in np.linspace(0.2 * width, 0.8 * width, TILES[1] + 1)[:-1].astype(int):
            bottom = top + (height - 2 * REACH) // TILES[0]
            right = left + int(0.6 * width / TILES[1])
            tile = flat[top:bottom, left:right]
            if tile.std() < 12:
                continue
            window = seen[top - REACH : bottom + REACH, left - REACH : right + REACH]
            place, score = peak(cv2.matchTemplate(window, tile, cv2.TM_CCOEFF_NORMED))
            if score > 0.6:
                shifts.append(place - REACH)
                scores.append(score)
    if len(shifts) < 10:
        return float("inf"), 0.0
    return float(np.linalg.norm(np.median(shifts, axis=0))), float(np.median(scores))


def turned(grid: np.ndarray) -> np.ndarray:
    return grid[::-1, ::-1]


def mirrored(grid: np.ndarray) -> np.ndarray:
    return grid[:, ::-1]


@pytest.mark.parametrize("name", PICTURES)
def test_the_print_lies_where_the_truth_says(name: str) -> None:
    shift, score = misfit(name, np.array(mug(name)["print_grid"]))
    assert shift < 0.5
    assert score > 0.8


@pytest.mark.parametrize("name", PICTURES)
@pytest.mark.parametrize("offset", [(1.5, 0), (0, -1.5), (1, 1)])
def test_a_shifted_truth_would_be_noticed(name: str, offset: tuple[float, float]) -> None:
    assert misfit(name, np.array(mug(name)["print_grid"]) + offset)[0] > 0.8


@pytest.mark.parametrize("name", PICTURES)
@pytest.mark.parametrize("wrong", [mirrored, turned])
def test_a_mirrored_truth_would_be_noticed(
    name: str, wrong: Callable[[np.ndarray], np.ndarray]
) -> None:
    # Tiles that fit nothing are left out, which flatters a wrong grid: either bar may stop it.
    shift, score = misfit(name, wrong(np.array(mug(name)["print_grid"])))
    assert shift > 0.5 or score < 0.8


@pytest.mark.parametrize("name", PICTURES)
def test_the_camera_sees_the_mug_stand_upright_on_the_ground(name: str) -> None:
    truth = images.truth(name)
    K, T_camera_from_world = (
        np.array(truth["camera"][key]) for key in ("K", "T_camera_from_world")
    )
    grid = np.array(mug(name)["print_grid"])
    rows, columns = grid.shape[:2]
    arc = PRINT_HEIGHT * drawing()[1] / RADIUS
    v, u = (g.ravel() for g in np.mgrid[0 : 1 : rows * 1j, 0 : 1 : columns * 1j])
    angle = (u - 0.5) * arc - np.pi / 2
    r = RADIUS + TRANSFER
    points = np.column_stack(
        [r * np.cos(angle), r * np.sin(angle), PRINT_FOOT + PRINT_HEIGHT * (1 - v)]
    )
    pixels = grid.reshape(-1, 2)
    found, rotation, shift = cv2.solvePnP(points, pixels, K, None, flags=cv2.SOLVEPNP_SQPNP)
    assert found
    rotation, shift = cv2.solvePnPRefineLM(points, pixels, K, None, rotation, shift)
    projected = cv2.projectPoints(points, rotation, shift, K, None)[0].reshape(-1, 2)
    assert np.abs(projected - pixels).max() < 0.02
    T_camera_from_mug = np.eye(4)
    T_camera_from_mug[:3] = np.column_stack([cv2.Rodrigues(rotation)[0], shift])
    T_world_from_mug = np.linalg.inv(T_camera_from_world) @ T_camera_from_mug
    assert T_world_from_mug[2, 2] > np.cos(np.radians(0.1))
    assert abs(T_world_from_mug[2, 3]) < 0.0005


@pytest.mark.parametrize("name", PICTURES)
def test_the_record_is_consistent(name: str) -> None:
    record = mug(name)
    height, width = images.load(name).shape[:2]
    assert images.truth(name)["size"] == [width, height]
    grid = np.array(record["print_grid"])
    corners = grid[[0, -1, -1, 0], [0, 0, -1, -1]]
    assert np.abs(corners - record["print_corners"]).max() < 1e-3
    assert record["visible"] > 0.95
    outline = np.array(record["outline"], np.float32)
    for point in grid[:, 2:-2].reshape(-1, 2).tolist():
        assert cv2.pointPolygonTest(outline, point, measureDist=False) > 0


def test_the_shelfs_homography_takes_the_templates_corners_to_its_own() -> None:
    H = np.array(mug("ROS2.png")["homography_print"])
    there = cv2.perspectiveTransform(np.array([mug("ROS.png")["print_corners"]]), H)[0]
    assert np.abs(there - mug("ROS2.png")["print_corners"]).max() < 0.05


@pytest.mark.parametrize("name", CUT_OUT)
def test_the_outline_is_the_cut_outs_own(name: str) -> None:
    opaque = np.uint8(images.load(name, alpha=True)[..., 3] > 127)
    # The outline is the outer one: the hole between the handle and the body counts as mug.
    contours, _ = cv2.findContours(opaque, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    alpha = cv2.drawContours(np.zeros_like(opaque), contours, -1, 1, cv2.FILLED) > 0
    outline = np.array(mug(name)["outline"], np.int32)
    inside = cv2.fillPoly(np.zeros(alpha.shape, np.uint8), [outline], 1) > 0
    assert (alpha & inside).sum() / (alpha | inside).sum() > 0.98
    moved = np.roll(inside, (6, 6), axis=(0, 1))
    assert (alpha & moved).sum() / (alpha | moved).sum() < 0.98


def test_there_are_enough_backgrounds() -> None:
    assert len(BACKGROUNDS) >= 4


@pytest.mark.parametrize("name", BACKGROUNDS)
def test_backgrounds_hold_no_mug(name: str) -> None:
    assert images.load(name).shape == (600, 900, 3)
    assert images.truth(name)["objects"] == {}
