"""The FAST viewer filters in the browser: prove that its filter is OpenCV's FAST."""

import base64
import re

import cv2
import numpy as np
import pytest

from course_lib import explore
from course_lib.segment_test import is_maximum, score_map


def _photo_like(seed: int) -> np.ndarray:
    """Textured grey picture with flat parts, edges and the full range of contrasts."""
    rng = np.random.default_rng(seed)
    grey = cv2.GaussianBlur(rng.integers(0, 256, (90, 140), dtype=np.uint8), (0, 0), 0.8 + seed)
    grey = cv2.normalize(grey, None, 0, 255, cv2.NORM_MINMAX)
    for _ in range(8):
        (x, y), (w, h) = rng.integers(0, 120, 2), rng.integers(3, 40, 2)
        grey[y : y + h, x : x + w] = rng.integers(0, 256)
    return grey


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("nonmax", [False, True])
def test_corners_at_every_threshold_are_opencvs(seed: int, *, nonmax: bool) -> None:
    grey = _photo_like(seed)
    scores = score_map(grey)
    assert scores.max() > 100
    if nonmax:
        scores = np.where(is_maximum(scores), scores, 0)
    for threshold in range(1, 256):
        detector = cv2.FastFeatureDetector_create(threshold, nonmax)
        expected = {tuple(map(int, k.pt)) for k in detector.detect(grey)}
        filtered = {(int(x), int(y)) for y, x in np.argwhere(scores >= threshold)}
        assert filtered == expected, f"threshold {threshold}"


def test_scores_are_opencvs_responses() -> None:
    grey = _photo_like(1)
    scores = score_map(grey)
    found = cv2.FastFeatureDetector_create(1, nonmaxSuppression=True).detect(grey)
    assert len(found) > 100
    assert all(scores[int(k.pt[1]), int(k.pt[0])] == k.response for k in found)


def test_viewer_sends_corners_best_first_and_starts_with_the_count_of_opencv() -> None:
    grey = _photo_like(0)
    viewer = explore.fast(grey, threshold=30)
    canvas = viewer.children[-1]
    for kept in (True, False):
        name = "kept" if kept else "all"
        scores = np.frombuffer(getattr(canvas, f"{name}_scores"), np.uint8)
        points = np.frombuffer(getattr(canvas, f"{name}_points"), np.uint16).reshape(-1, 2)
        assert len(points) == len(scores)
        assert (np.diff(scores.astype(int)) <= 0).all()
        expected = cv2.FastFeatureDetector_create(30, kept).detect(grey)
        assert {tuple(map(int, k.pt)) for k in expected} == {
            tuple(map(int, p)) for p in points[scores >= 30]
        }
    count = len(cv2.FastFeatureDetector_create(30, nonmaxSuppression=True).detect(grey))
    assert f" {count} corners at threshold 30" in viewer.alt


def test_output_carries_view_still_picture_and_stable_text() -> None:
    viewers = [explore.fast(_photo_like(0)) for _ in range(2)]
    bundles = [viewer._repr_mimebundle_()[0] for viewer in viewers]
    assert bundles[0]["text/plain"] == bundles[1]["text/plain"]
    assert bundles[0]["image/png"] == bundles[1]["image/png"]
    assert not re.search(r"0x[0-9a-f]+", bundles[0]["text/plain"])
    assert "application/vnd.jupyter.widget-view+json" in bundles[0]
    still = base64.b64decode(bundles[0]["image/png"])
    assert len(still) <= 100_000
    decoded = cv2.imdecode(np.frombuffer(still, np.uint8), cv2.IMREAD_COLOR)
    assert decoded.shape[1] == 140


def test_still_of_a_noisy_large_picture_stays_small() -> None:
    noise = np.random.default_rng(0).integers(0, 256, (700, 1200, 3), dtype=np.uint8)
    bundle = explore.fast(noise, threshold=60)._repr_mimebundle_()[0]
    assert len(base64.b64decode(bundle["image/png"])) <= 100_000


def test_suppression_can_be_fixed_instead_of_switched() -> None:
    grey = _photo_like(0)
    assert len(explore.fast(grey).children) == 3
    fixed = explore.fast(grey, nonmax=False)
    assert len(fixed.children) == 2
    assert fixed.children[-1].nonmax is False


@pytest.mark.parametrize("shape", [(5, 5), (1, 1), (6, 200), (7, 7)])
def test_picture_too_small_for_a_corner_still_shows(shape: tuple[int, int]) -> None:
    viewer = explore.fast(np.full(shape, 128, np.uint8))
    assert " 0 corners" in viewer.alt


@pytest.mark.parametrize(
    ("image", "error"),
    [
        (None, TypeError),
        (np.zeros((20, 20), np.float32), TypeError),
        (np.zeros((0, 20), np.uint8), ValueError),
        (np.zeros((20, 20, 2), np.uint8), ValueError),
    ],
)
def test_what_is_no_picture_is_refused(image: object, error: type[Exception]) -> None:
    with pytest.raises(error, match="image must"):
        explore.fast(image)


def test_threshold_outside_grey_levels_is_refused() -> None:
    with pytest.raises(ValueError, match="threshold must be a grey level"):
        explore.fast(np.zeros((20, 20), np.uint8), threshold=0)
    with pytest.raises(ValueError, match="max_threshold must be a grey level"):
        explore.fast(np.zeros((20, 20), np.uint8), max_threshold=300)
