import numpy as np
import pytest
from test_homography import H_TRUE, points

from course_lib import homography
from course_lib.refine import keypoint_noise, point_sigma, refine

CORNERS = homography.template_corners((400, 300)).astype(float)


def noisy(seed, n=40):
    rng = np.random.default_rng(seed)
    source = points(n, seed)
    noise = rng.choice([0.5, 3.0], n)
    target = homography.project(H_TRUE, source) + rng.normal(0, 1, (n, 2)) * noise[:, None]
    return source, target, noise


def corner_error(H):
    off = homography.project(H, CORNERS) - homography.project(H_TRUE, CORNERS)
    return np.linalg.norm(off, axis=1)


def test_exact_points_give_the_exact_homography():
    source = points(12)
    start = H_TRUE + np.array([[0.02, 0, 3], [0, -0.02, -2], [1e-5, 0, 0]])
    target = homography.project(H_TRUE, source)
    H, _ = refine(start, source, target, np.ones(12), iterations=10)
    assert np.allclose(H, H_TRUE, atol=1e-6)


def test_weights_beat_the_plain_fit():
    plain, weighted = [], []
    for seed in range(20):
        source, target, noise = noisy(seed)
        start = homography.estimate(source, target, method=0, threshold=0)
        H, _ = refine(start, source, target, noise)
        plain.append(corner_error(start).max())
        weighted.append(corner_error(H).max())
    assert np.median(weighted) < 0.6 * np.median(plain)


def test_sigma_tells_the_error():
    ratios = []
    for seed in range(60):
        source, target, noise = noisy(seed)
        H, covariance = refine(H_TRUE, source, target, noise)
        ratios.append(corner_error(H) / point_sigma(H, covariance, CORNERS))
    assert 0.5 < np.sqrt(np.mean(np.square(ratios))) < 1.5


def test_clustered_points_leave_far_corners_uncertain():
    source, target, noise = noisy(0)
    _, spread = refine(H_TRUE, source, target, noise)
    near = source * 0.1
    rng = np.random.default_rng(0)
    target = homography.project(H_TRUE, near) + rng.normal(0, 0.3, near.shape)
    H, clustered = refine(H_TRUE, near, target, noise)
    far = point_sigma(H, clustered, CORNERS).max()
    assert far > 5 * point_sigma(H_TRUE, spread, CORNERS).max()


def test_points_that_fix_nothing_are_none_or_hopeless():
    line = np.stack([np.arange(10.0), np.arange(10.0)], axis=1)
    fit = refine(np.eye(3), line, line, np.ones(10))
    assert fit is None or not point_sigma(*fit, CORNERS).max() < 100


def test_noise_follows_size_and_scale():
    half = np.diag([0.5, 0.5, 1.0])
    noise = keypoint_noise(half, np.zeros((2, 2)), np.array([[31.0, 31.0], [62.0, 62.0]]))
    assert noise[1] == pytest.approx(2 * noise[0])
    assert noise[0] == pytest.approx(np.hypot(0.5, 1) / np.sqrt(2))
