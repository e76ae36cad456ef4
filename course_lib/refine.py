"""Polish a homography on its inliers, and tell how precisely they fix the outline."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from course_lib.homography import jacobians, project

Matrix = NDArray[np.float64]

# Residuals, in units of a keypoint's own noise, beyond which a match loses weight (Cauchy).
CAUCHY_SCALE = 1.0
# ORB's and SIFT's keypoints are localised to about 1/30 of their size (one pixel of their octave).
NOISE_PER_SIZE = 1 / 31
MIN_NOISE = 0.3


def keypoint_noise(H: Matrix, template_points: Matrix, sizes: Matrix) -> NDArray[np.float64]:
    """
    Return each match's expected error in scene pixels: both keypoints', the template's mapped.

    Parameters
    ----------
    H : ndarray, shape (3, 3)
    template_points : ndarray, shape (N, 2)
    sizes : ndarray, shape (N, 2)
        Keypoint sizes in template and scene.

    Returns
    -------
    ndarray of float64, shape (N,)
    """
    growth = np.sqrt(np.abs(np.linalg.det(jacobians(H, template_points))))
    noise = np.hypot(sizes[:, 0] * growth, sizes[:, 1]) * (NOISE_PER_SIZE / np.sqrt(2))
    return np.asarray(np.maximum(noise, MIN_NOISE), np.float64)


def refine(
    H: Matrix,
    template_points: Matrix,
    scene_points: Matrix,
    noise: NDArray[np.float64],
    *,
    iterations: int = 5,
) -> tuple[Matrix, Matrix] | None:
    """
    Minimise the reprojection error, robustly and weighted by each match's noise.

    A coarse octave's keypoint is off by several pixels where a fine one's is off by one; treating
    them alike, as a plain least-squares fit does, spoils the corners.

    Parameters
    ----------
    H : ndarray, shape (3, 3)
        Start; H[2, 2] is 1.
    template_points, scene_points : ndarray, shape (N, 2)
        Inliers.
    noise : ndarray, shape (N,)
        Expected error of each, in scene pixels.
    iterations : int
        Gauss-Newton steps.

    Returns
    -------
    (H, covariance) or None
        Covariance (8, 8) of the first eight entries of H, row by row. None when the inliers do
        not fix a homography.
    """
    # Columns differ by a factor of about size^2; without this the normal equations are useless.
    reach = max(float(np.abs(template_points).max()), 1.0)
    unit = np.array([reach, reach, 1, reach, reach, 1, reach**2, reach**2])
    for _ in range(iterations):
        J = _derivatives(H, template_points) / unit
        residuals = scene_points - project(H, template_points)
        distances = np.linalg.norm(residuals, axis=1) / noise
        weights = 1 / (noise**2 * (1 + (distances / CAUCHY_SCALE) ** 2))
        normal = np.einsum("nai,n,naj->ij", J, weights, J)
        gradient = np.einsum("nai,n,na->i", J, weights, residuals)
        try:
            step = np.linalg.solve(normal, gradient) / unit
            covariance = np.linalg.inv(normal) / np.outer(unit, unit)
        except np.linalg.LinAlgError:
            return None
        H = H + np.append(step, 0).reshape(3, 3)
        if not np.isfinite(H).all():
            return None
    # Residuals tell whether the assumed noise was too small; never call the result better.
    spare = max(2 * len(residuals) - 8, 1)
    excess = float(np.sum(weights[:, None] * residuals**2)) / spare
    return H, covariance * max(excess, 1.0)


def point_sigma(H: Matrix, covariance: Matrix, points: Matrix) -> NDArray[np.float64]:
    """
    Return how uncertain mapped points are.

    Parameters
    ----------
    H : ndarray, shape (3, 3)
    covariance : ndarray, shape (8, 8)
        From :func:`refine`.
    points : ndarray, shape (N, 2)

    Returns
    -------
    ndarray of float64, shape (N,)
        Standard deviation in scene pixels, both coordinates together.
    """
    J = _derivatives(H, points)
    variance = np.einsum("nai,ij,naj->n", J, covariance, J)
    return np.asarray(np.sqrt(np.maximum(variance, 0)), np.float64)


def _derivatives(H: Matrix, points: Matrix) -> Matrix:
    """Return d(mapped x, y) / d(h11 ... h32), shape (N, 2, 8)."""
    x, y = points[:, 0], points[:, 1]
    mapped = project(H, points)
    inverse = 1 / (points @ H[2, :2] + 1)
    J = np.zeros((len(points), 2, 8))
    J[:, 0, 0] = J[:, 1, 3] = x * inverse
    J[:, 0, 1] = J[:, 1, 4] = y * inverse
    J[:, 0, 2] = J[:, 1, 5] = inverse
    J[:, :, 6] = -mapped * (x * inverse)[:, None]
    J[:, :, 7] = -mapped * (y * inverse)[:, None]
    return J
