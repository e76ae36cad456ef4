import cv2
import numpy as np
import pytest
from scenery import TEMPLATE_SIZE, view

from course_lib import homography

H_TRUE = np.array([[0.8, 0.15, 40], [-0.1, 0.7, 90], [2e-4, -1e-4, 1]])


def points(count, seed=0):
    return np.random.default_rng(seed).uniform(0, 400, (count, 2))


def test_project_is_opencvs():
    source = points(50)
    expected = cv2.perspectiveTransform(source[None], H_TRUE)[0]
    assert np.allclose(homography.project(H_TRUE, source), expected)


def test_a_point_at_infinity_is_no_warning():
    H = np.array([[1, 0, 0], [0, 1, 0], [-0.01, 0, 1.0]])
    far = homography.project(H, np.array([[100.0, 5.0]]))
    assert not np.isfinite(far).any()
    errors = homography.reprojection_errors(H, np.array([[100.0, 0.0]]), np.zeros((1, 2)))
    assert np.isinf(errors).all()


def test_jacobians_are_derivatives():
    source, step = points(20), 1e-4
    J = homography.jacobians(H_TRUE, source)
    for axis in (0, 1):
        shift = np.zeros(2)
        shift[axis] = step
        ahead = homography.project(H_TRUE, source + shift)
        behind = homography.project(H_TRUE, source - shift)
        assert np.allclose(J[:, :, axis], (ahead - behind) / (2 * step), atol=1e-5)


@pytest.mark.parametrize("method", homography.METHODS.values(), ids=homography.METHODS.keys())
def test_estimate_among_outliers(method):
    rng = np.random.default_rng(1)
    source = points(100)
    target = homography.project(H_TRUE, source) + rng.normal(0, 0.3, (100, 2))
    target[70:] = rng.uniform(0, 600, (30, 2))
    H = homography.estimate(source, target, method=method, threshold=3)
    corners = homography.template_corners(TEMPLATE_SIZE)
    off = homography.project(H, corners) - homography.project(H_TRUE, corners)
    assert np.abs(off).max() < 2
    assert H[2, 2] == 1


def test_a_seed_is_another_draw_and_the_same_seed_the_same():
    rng = np.random.default_rng(1)
    source, target = points(60), points(60, 1)
    target[:20] = homography.project(H_TRUE, source[:20]) + rng.normal(0, 1.5, (20, 2))
    code = cv2.RANSAC
    fits = [
        homography.estimate(source, target, method=code, threshold=4, max_iterations=50, seed=seed)
        for seed in (0, 1, 1, 2)
    ]
    assert np.array_equal(fits[1], fits[2])
    assert not np.array_equal(fits[0], fits[1]) or not np.array_equal(fits[1], fits[3])


@pytest.mark.parametrize("method", homography.METHODS.values(), ids=homography.METHODS.keys())
@pytest.mark.parametrize(
    "source",
    [points(3), np.zeros((10, 2)), np.stack([np.arange(10.0), np.arange(10.0)], axis=1)],
    ids=["three", "one place", "a line"],
)
def test_degenerate_points_are_none_or_finite(method, source):
    H = homography.estimate(source, source * 2, method=method, threshold=3)
    assert H is None or np.isfinite(H).all()
    assert len(source) > 3 or H is None


def test_corners_are_pixel_centres_in_the_course_order():
    corners = homography.template_corners((400, 300))
    assert corners.tolist() == [[0, 0], [0, 299], [399, 299], [399, 0]]


def test_views_are_normalised():
    H = view(np.random.default_rng(0), tilt=0.3, scale=0.5)
    assert H[2, 2] == 1
