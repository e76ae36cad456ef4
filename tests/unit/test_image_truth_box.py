"""The box scenes' truth agrees with their pixels; a wrong camera convention cannot pass."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from course_lib import images

SCENES = ["box_in_scene.png", "box_in_scene_rotated.png", "box_in_scene_hidden.png"]


def edges(picture: np.ndarray) -> np.ndarray:
    """Where grey values change, whatever the light."""
    grey = cv2.GaussianBlur(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), (0, 0), 1).astype(np.float32)
    return cv2.magnitude(cv2.Sobel(grey, cv2.CV_32F, 1, 0), cv2.Sobel(grey, cv2.CV_32F, 0, 1))


def misfit(name: str, H: np.ndarray) -> tuple[float, float]:
    """Best shift of the warped template upon the scene, pixels, and its correlation there.

    The cover is cut into tiles; a hidden tile correlates with nothing and is left out.
    """
    scene, box = edges(images.load(name)), images.load("box.png")
    warped = edges(cv2.warpPerspective(box, H, scene.shape[::-1]))
    shifts, peaks = [], []
    for y in range(20, 220, 40):
        for x in range(20, 320, 50):
            corners = cv2.perspectiveTransform(
                np.float64([[[x, y], [x + 50, y], [x + 50, y + 40], [x, y + 40]]]), H
            )[0]
            left, top = np.floor(corners.min(0)).astype(int)
            right, bottom = np.ceil(corners.max(0)).astype(int)
            reach = 8
            if left < reach or top < reach:
                continue
            window = scene[top - reach : bottom + reach, left - reach : right + reach]
            tile = warped[top:bottom, left:right]
            if min(tile.shape) < 8 or window.shape[0] <= tile.shape[0] or tile.std() < 1:
                continue
            found = cv2.matchTemplate(window, tile, cv2.TM_CCOEFF_NORMED)
            _, peak, _, place = cv2.minMaxLoc(found)
            if peak > 0.6:
                shifts.append(np.array(place) - reach)
                peaks.append(peak)
    if len(shifts) < 6:
        return float("inf"), 0.0
    return float(np.linalg.norm(np.mean(shifts, axis=0))), float(np.median(peaks))


def truth(name: str) -> tuple[np.ndarray, np.ndarray]:
    box = images.truth(name)["objects"]["box"]
    return np.array(box["homography"]), np.array(box["corners"])


@pytest.mark.parametrize("name", SCENES)
def test_cover_lies_where_the_truth_says(name: str) -> None:
    H, _ = truth(name)
    shift, peak = misfit(name, H)
    assert shift < 0.7
    assert peak > 0.75


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("offset", [(2, 0), (0, -2), (0.5 + 1, 0.5 + 1)])
def test_a_shifted_truth_would_be_noticed(name: str, offset: tuple[float, float]) -> None:
    H, _ = truth(name)
    moved = np.array([[1, 0, offset[0]], [0, 1, offset[1]], [0, 0, 1]]) @ H
    shift, _ = misfit(name, moved)
    assert shift > 1.2


@pytest.mark.parametrize("name", SCENES)
def test_a_mirrored_truth_would_be_noticed(name: str) -> None:
    H, _ = truth(name)
    width = images.load("box.png").shape[1]
    mirrored = H @ np.array([[-1, 0, width - 1], [0, 1, 0], [0, 0, 1]])
    assert misfit(name, mirrored)[0] == float("inf")


@pytest.mark.parametrize("name", SCENES)
def test_corners_are_the_homographys_corners_in_order(name: str) -> None:
    H, corners = truth(name)
    h, w = images.load("box.png").shape[:2]
    outline = np.float64([[[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]])
    assert np.abs(cv2.perspectiveTransform(outline, H)[0] - corners).max() < 0.05


def test_only_one_scene_hides_a_third_of_the_cover() -> None:
    visible = [images.truth(name)["objects"]["box"]["visible"] for name in SCENES]
    assert visible[0] > 0.95
    assert visible[1] > 0.95
    assert 0.5 < visible[2] < 0.8
