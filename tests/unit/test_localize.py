import cv2
import numpy as np
import pytest

from course_lib.localize import Detection, TemplateLocator, locate_template


def texture(seed, width=640, height=480):
    """Blobs, bars and letters of many sizes: corners that ORB and SIFT both like."""
    rng = np.random.default_rng(seed)
    picture = np.full((height, width, 3), rng.integers(60, 200, 3), np.uint8)
    for _ in range(120):
        x, y = (int(rng.integers(0, side)) for side in (width, height))
        ink = tuple(int(c) for c in rng.integers(0, 256, 3))
        shape = rng.integers(0, 3)
        if shape == 0:
            end = (x + int(rng.integers(5, 70)), y + int(rng.integers(5, 70)))
            cv2.rectangle(picture, (x, y), end, ink, -1)
        elif shape == 1:
            cv2.circle(picture, (x, y), int(rng.integers(3, 30)), ink, -1, cv2.LINE_AA)
        else:
            letter = chr(int(rng.integers(65, 91)))
            scale = float(rng.uniform(0.5, 2.5))
            cv2.putText(picture, letter, (x, y), cv2.FONT_HERSHEY_SIMPLEX, scale, ink, 3)
    noisy = picture + rng.normal(0, 4, picture.shape)
    return np.clip(noisy, 0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def template():
    return texture(1, 400, 300)


def test_finds_a_warped_template_to_a_pixel(template):
    H = np.array([[0.7, -0.2, 180], [0.25, 0.75, 40], [2e-4, 1e-4, 1]])
    scene = texture(2)
    warped = cv2.warpPerspective(template, H, (640, 480), flags=cv2.INTER_AREA)
    mask = cv2.warpPerspective(np.full((300, 400), 255, np.uint8), H, (640, 480))
    scene[mask > 0] = warped[mask > 0]
    truth = cv2.perspectiveTransform(
        np.float32([[[0, 0], [0, 299], [399, 299], [399, 0]]]), H
    ).reshape(4, 2)
    detection = locate_template(template, scene)
    assert detection
    assert detection.corners.dtype == np.float32
    assert np.abs(detection.corners - truth).max() < 1.5
    assert detection.inliers.shape == (len(detection.matches),)
    assert np.linalg.norm(detection.homography - H) / np.linalg.norm(H) < 0.02


def test_absent_template_is_falsy_with_a_reason(template):
    detection = locate_template(template, texture(7))
    assert not detection
    assert isinstance(detection, Detection)
    assert detection.corners is None
    assert detection.homography is None
    assert detection.reason


def test_locator_gives_the_same_as_the_function(template):
    scene = cv2.copyMakeBorder(template, 60, 60, 80, 80, cv2.BORDER_REFLECT)
    once = locate_template(template, scene)
    stream = TemplateLocator(template)
    for _ in range(2):
        again = stream.locate(scene)
        assert np.array_equal(once.corners, again.corners)
