"""The flights' truth agrees with their pixels; a wrong camera convention cannot pass.

The house's front wall is a plane of the world. Two cameras that see it are related by a homography
that follows from the truth alone; OpenCV's matches on the wall must obey it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from course_lib import camera, images

FLIGHTS = ["flight.bag", "heldout/flight_a.bag", "heldout/flight_b.bag"]
# East-west and vertical extent of the wall, metres, away from the well that stands before it.
WALL_X, WALL_Z = (-7.4, 1.2), (0.4, 2.8)


@pytest.fixture(scope="module", params=FLIGHTS)
def flight(request: pytest.FixtureRequest) -> Iterator[tuple[list[Any], dict[str, Any]]]:
    with camera.open_camera(images.path(request.param)) as source:
        yield list(source), images.truth(request.param)


def wall_from_pixels(T: np.ndarray, K: np.ndarray, wall_y: float) -> np.ndarray:
    """Homography that takes pixels to (x, z) on the wall."""
    R, t = T[:3, :3], T[:3, 3]
    pixels_from_wall = K @ np.column_stack([R[:, 0], R[:, 2], R[:, 1] * wall_y + t])
    return np.linalg.inv(pixels_from_wall)


def apply(H: np.ndarray, points: np.ndarray) -> np.ndarray:
    return cv2.perspectiveTransform(points[None].astype(np.float64), H)[0]


@lru_cache(maxsize=64)
def features(pixels: bytes, shape: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    grey = cv2.cvtColor(np.frombuffer(pixels, np.uint8).reshape(shape), cv2.COLOR_BGR2GRAY)
    # SIFT places its keypoints to a fraction of a pixel, ORB only to one or two.
    keypoints, descriptors = cv2.SIFT_create(1500).detectAndCompute(grey, None)
    return np.array([k.pt for k in keypoints]), descriptors


def wall_error(
    flight: tuple[list[Any], dict[str, Any]],
    change: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]] = lambda T, K: (T, K),
    step: int = 4,
) -> float:
    """Median distance in pixels between wall matches and where the truth says they should be.

    Infinite when hardly a match lies where the cameras are said to see the wall.
    """
    frames, truth = flight
    matcher = cv2.BFMatcher(cv2.NORM_L2, crossCheck=True)
    errors: list[float] = []
    for i in range(0, len(frames) - step, max(step, len(frames) // 10)):
        Hs, found = [], []
        for frame in (frames[i], frames[i + step]):
            record = frame.truth
            T, K = change(np.array(record["T_camera_from_world"]), np.array(truth["camera"]["K"]))
            Hs.append(wall_from_pixels(T, K, truth["wall_y"]))
            found.append(features(frame.image.tobytes(), frame.image.shape))
        matches = [m for m in matcher.match(found[0][1], found[1][1]) if m.distance < 150]
        if len(matches) < 20:
            continue
        a = found[0][0][[m.queryIdx for m in matches]]
        b = found[1][0][[m.trainIdx for m in matches]]
        x, z = apply(Hs[0], a).T
        on_wall = (x > WALL_X[0]) & (x < WALL_X[1]) & (z > WALL_Z[0]) & (z < WALL_Z[1])
        if not on_wall.any():
            continue
        predicted = apply(np.linalg.inv(Hs[1]) @ Hs[0], a[on_wall])
        errors.extend(np.linalg.norm(predicted - b[on_wall], axis=1))
    return float(np.median(errors)) if len(errors) > 100 else np.inf


def test_wall_moves_as_the_truth_says(flight: tuple[list[Any], dict[str, Any]]) -> None:
    assert wall_error(flight) < 0.7


def mirrored(T: np.ndarray, K: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.diag([-1.0, 1, 1, 1]) @ T, K


def flipped_axes(T: np.ndarray, K: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.diag([1.0, -1, -1, 1]) @ T, K


def longer_lens(T: np.ndarray, K: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return T, K @ np.diag([1.15, 1.15, 1])


@pytest.mark.parametrize("wrong", [mirrored, flipped_axes, longer_lens])
def test_a_wrong_camera_would_be_noticed(
    flight: tuple[list[Any], dict[str, Any]],
    wrong: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]],
) -> None:
    assert wall_error(flight, wrong, step=8) > 2 * wall_error(flight, step=8)


def inside_share(polygon: np.ndarray, mask: np.ndarray) -> float:
    area = cv2.fillPoly(np.zeros(mask.shape, np.uint8), [polygon.astype(np.int32)], 1)
    return float(mask[area > 0].mean())


def test_silhouette_lies_on_the_roof_and_the_stones(
    flight: tuple[list[Any], dict[str, Any]],
) -> None:
    frames, _ = flight
    gains = []
    for frame in frames[::5]:
        if frame.truth["well"]["visible"] < 0.99:
            continue
        polygon = np.array(frame.truth["well"]["polygon"])
        hsv = cv2.cvtColor(frame.image, cv2.COLOR_BGR2HSV)
        # The lawn is the only thing round the well's foot: green outside, no green inside.
        green = ((hsv[..., 0] > 38) & (hsv[..., 0] < 75) & (hsv[..., 1] > 90)).astype(np.uint8)
        foot = polygon[polygon[:, 1] > np.percentile(polygon[:, 1], 45)]
        gains.append(inside_share(foot + [60, 0], green) - inside_share(foot, green))
        gains.append(inside_share(foot + [-60, 0], green) - inside_share(foot, green))
    assert np.mean(gains) > 0.1


def best_shift(frames: list[Any], *, reach: int = 5) -> np.ndarray:
    """Shift of the silhouettes, in pixels, at which they lie best on the pictures' edges."""
    shifts = [(x, y) for x in range(-reach, reach + 1) for y in range(-reach, reach + 1)]
    strength = np.zeros(len(shifts))
    for frame in frames:
        grey = cv2.GaussianBlur(cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY), (0, 0), 1.2)
        grey = grey.astype(np.float32)
        edges = np.hypot(cv2.Sobel(grey, cv2.CV_32F, 1, 0), cv2.Sobel(grey, cv2.CV_32F, 0, 1))
        edges = np.pad(edges, reach)
        outline = np.zeros(frame.image.shape[:2], np.uint8)
        polygon = np.array(frame.truth["well"]["polygon"], np.int32)
        y, x = np.nonzero(cv2.polylines(outline, [polygon], isClosed=True, color=1))
        strength += [edges[y + dy + reach, x + dx + reach].mean() for dx, dy in shifts]
    return np.array(shifts[int(strength.argmax())])


@pytest.mark.parametrize("moved", [(0, 0), (3, 0), (0, -3)])
def test_silhouette_lies_on_edges_and_a_shift_is_noticed(
    flight: tuple[list[Any], dict[str, Any]], moved: tuple[int, int]
) -> None:
    whole = [frame for frame in flight[0] if frame.truth["well"]["visible"] == 1][::6]
    shifted = [replace(frame, image=np.roll(frame.image, moved, axis=(1, 0))) for frame in whole]
    assert np.abs(best_shift(shifted) - moved).max() <= 1


def test_well_leaves_and_comes_back() -> None:
    visible = [frame["well"]["visible"] for frame in images.truth("flight.bag")["frames"]]
    assert len(visible) >= 240
    gone = [i for i, share in enumerate(visible) if share == 0]
    assert gone
    assert max(visible[: gone[0]]) > 0.99
    assert max(visible[gone[-1] :]) > 0.99


def test_stamps_belong_to_the_frames(flight: tuple[list[Any], dict[str, Any]]) -> None:
    frames, truth = flight
    assert [f.stamp_ns for f in frames] == [f["stamp_ns"] for f in truth["frames"]]
    assert all(f.image.shape == (480, 640, 3) for f in frames)


def test_pictures_are_small_enough_to_clone() -> None:
    files = [p for p in Path(images.folder()).rglob("*") if p.is_file()]
    assert sum(p.stat().st_size for p in files) < 40e6
    pictures = [p for p in files if p.suffix in {".png", ".jpg"}]
    assert [p.name for p in pictures if p.stat().st_size > 1.5e6] == []
