import numpy as np
import pytest
from test_homography import H_TRUE, points

from course_lib import homography
from course_lib.refine import keypoint_noise, refine, similarity

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


def test_exact_points_give_nearly_the_exact_homography():
    source = points(40)
    start = H_TRUE + np.array([[0.02, 0, 3], [0, -0.02, -2], [1e-5, 0, 0]])
    target = homography.project(H_TRUE, source)
    refined = refine(start, source, target, np.full(40, 0.3), CORNERS, iterations=10)
    # Nearly: the prior on the view pulls a little.
    assert corner_error(refined.H).max() < 0.05
    assert refined.H[2, 2] == 1


def test_weights_beat_the_plain_fit():
    plain, weighted = [], []
    for seed in range(20):
        source, target, noise = noisy(seed)
        start = homography.estimate(source, target, method=0, threshold=0)
        plain.append(corner_error(start).max())
        weighted.append(corner_error(refine(start, source, target, noise, CORNERS).H).max())
    assert np.median(weighted) < 0.6 * np.median(plain)


def test_sigma_tells_the_error():
    ratios = []
    for seed in range(60):
        refined = refine(H_TRUE, *noisy(seed), CORNERS)
        ratios.append(corner_error(refined.H) / refined.sigma)
    assert 0.5 < np.sqrt(np.mean(np.square(ratios))) < 1.5


def clustered(seed, n=12):
    """Inliers in one corner of the template: they leave tilt and perspective open."""
    rng = np.random.default_rng(seed)
    source = rng.uniform(0, 60, (n, 2))
    return source, homography.project(H_TRUE, source) + rng.normal(0, 1, (n, 2)), np.ones(n)


def test_clustered_points_leave_far_corners_uncertain():
    spread = refine(H_TRUE, *noisy(0), CORNERS).sigma
    near = refine(H_TRUE, *clustered(0), CORNERS).sigma
    assert near.max() > 5 * spread.max()
    # The corner where the points are is known all the same.
    assert near[0] < near.max() / 4


def test_the_prior_keeps_clustered_points_from_making_up_perspective():
    with_prior, plain = [], []
    for seed in range(30):
        source, target, noise = clustered(seed)
        fit = homography.estimate(source, target, method=0, threshold=0)
        plain.append(corner_error(fit).max())
        start = similarity(source, target)
        with_prior.append(corner_error(refine(start, source, target, noise, CORNERS).H).max())
    assert np.median(with_prior) < 0.5 * np.median(plain)
    assert max(with_prior) < 250


def test_points_on_a_line_are_filled_in_by_the_prior():
    line = np.stack([np.linspace(0, 399, 30), np.full(30, 150.0)], axis=1)
    H = np.array([[0.5, 0.1, 20], [-0.1, 0.5, 90], [0, 0, 1.0]])
    refined = refine(
        similarity(line, homography.project(H, line)),
        line,
        homography.project(H, line),
        np.ones(30),
        CORNERS,
    )
    off = homography.project(refined.H, CORNERS) - homography.project(H, CORNERS)
    assert np.abs(off).max() < 2
    assert refined.sigma.max() > 10


def test_similarity_is_exact_for_one():
    H = np.array([[0.5, 0.1, 20], [-0.1, 0.5, 90], [0, 0, 1.0]])
    source = points(5)
    assert np.allclose(similarity(source, homography.project(H, source)), H)
    assert np.isfinite(similarity(np.zeros((4, 2)), source[:4])).all()


def test_noise_follows_size_and_scale():
    half = np.diag([0.5, 0.5, 1.0])
    noise = keypoint_noise(half, np.zeros((2, 2)), np.array([[31.0, 31.0], [62.0, 62.0]]))
    assert noise[1] == pytest.approx(2 * noise[0])
    assert noise[0] == pytest.approx(np.hypot(0.5, 1) / np.sqrt(2))
