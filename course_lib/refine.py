"""Polish a homography on its inliers, and tell how precisely they fix the outline."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from course_lib.homography import jacobians, project

Matrix = NDArray[np.float64]

# Residuals, in units of a keypoint's own noise, beyond which a match loses weight (Cauchy).
CAUCHY_SCALE = 1.0
# ORB's and SIFT's keypoints are localised to about 1/30 of their size (one pixel of their octave).
NOISE_PER_SIZE = 1 / 31
MIN_NOISE = 0.3

# What is believed of a view before any match is seen, as standard deviations. Relative change of
# depth across the template: seen from two diagonals away and tilted by 45 degrees, a third.
PERSPECTIVE_SIGMA = 0.3
# Departure from a similarity: tilting by 45 degrees shortens one direction by 0.7.
SHAPE_SIGMA = 0.35

# A step that moves nothing by more than this many pixels ends the iteration.
ENOUGH = 0.02


@dataclass(frozen=True, eq=False)
class Refined:
    """
    A polished homography.

    Attributes
    ----------
    H : ndarray of float64, shape (3, 3)
        H_scene_from_template, H[2, 2] = 1.
    sigma : ndarray of float64, shape (4,)
        Standard deviations of the template's mapped corners in scene pixels.
    """

    H: Matrix
    sigma: NDArray[np.float64]


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
    corners: Matrix,
    *,
    iterations: int = 8,
) -> Refined | None:
    """
    Minimise the reprojection error, robustly, weighted by noise, with a prior on the view.

    A coarse octave's keypoint is off by several pixels where a fine one's is off by one; treating
    them alike, as a plain least-squares fit does, spoils the corners. And few inliers, or inliers
    along a line, leave tilt and perspective open, which a plain fit makes up from noise; a weak
    prior, the view of an object from straight ahead, fills in only what they leave open.

    Parameters
    ----------
    H : ndarray, shape (3, 3)
        Start.
    template_points, scene_points : ndarray, shape (N, 2)
        Inliers.
    noise : ndarray, shape (N,)
        Expected error of each, in scene pixels.
    corners : ndarray, shape (4, 2)
        The template's corners.
    iterations : int
        Gauss-Newton steps, at most.

    Returns
    -------
    Refined or None
        None when the steps lead nowhere.
    """
    # Coordinates in which the eight parameters mean something: around the template's centre, in
    # units of its diagonal, and around where that centre is in the scene.
    centre = corners.mean(axis=0)
    extent = float(np.linalg.norm(corners[2] - corners[0])) + 1.0
    origin = project(H, centre[None])[0]
    to_unit = np.array([[1, 0, -centre[0]], [0, 1, -centre[1]], [0, 0, extent]]) / extent
    to_scene = np.array([[1, 0, origin[0]], [0, 1, origin[1]], [0, 0, 1]])
    G = np.linalg.inv(to_scene) @ H @ np.linalg.inv(to_unit)
    G /= G[2, 2]
    source, target = project(to_unit, template_points), scene_points - origin
    spare = max(2 * len(source) - 8, 1)
    for _ in range(iterations):
        mapped, J = _map(G, source)
        residuals = target - mapped
        squares = np.einsum("na,na->n", residuals, residuals)
        weights = 1 / (noise**2 + squares / CAUCHY_SCALE**2)
        # If residuals are larger than the assumed noise, the noise was larger; never smaller.
        weights /= max(float(weights @ squares) / spare, 1.0)
        beliefs = _beliefs(G)
        weighted = (J * weights[:, None, None]).reshape(-1, 8)
        normal = weighted.T @ J.reshape(-1, 8) + beliefs.T @ beliefs
        gradient = weighted.T @ residuals.ravel() - beliefs.T @ (beliefs @ G.ravel()[:8])
        try:
            covariance = np.linalg.inv(normal)
        except np.linalg.LinAlgError:
            return None
        step = covariance @ gradient
        G = G + np.append(step, 0).reshape(3, 3)
        if not np.isfinite(step).all():
            return None
        # In these units the first six parameters are pixels at the template's rim.
        if np.abs(step).max() < ENOUGH:
            break
    _, probes = _map(G, project(to_unit, corners))
    sigma = np.sqrt(np.einsum("nai,ij,naj->n", probes, covariance, probes))
    polished = to_scene @ G @ to_unit
    if abs(polished[2, 2]) < 1e-12 or not np.isfinite(sigma).all():
        return None
    return Refined(polished / polished[2, 2], sigma)


def similarity(template_points: Matrix, scene_points: Matrix) -> Matrix:
    """
    Return the least-squares similarity as a homography: the start that never folds.

    Parameters
    ----------
    template_points, scene_points : ndarray, shape (N, 2)

    Returns
    -------
    ndarray of float64, shape (3, 3)
    """
    source, target = (points @ [1, 1j] for points in (template_points, scene_points))
    around = source - source.mean()
    # np.vdot conjugates its first argument; a sole spot has no scale, so leave it alone.
    z = np.vdot(around, target) / max(float(np.vdot(around, around).real), 1e-9) or 1.0
    shift = target.mean() - z * source.mean()
    return np.array([[z.real, -z.imag, shift.real], [z.imag, z.real, shift.imag], [0, 0, 1.0]])


def _beliefs(G: Matrix) -> Matrix:
    """Return the prior as rows that, times the parameters, give standard normal numbers."""
    size = np.sqrt(abs(G[0, 0] * G[1, 1] - G[0, 1] * G[1, 0])) + 1e-9
    rows = np.zeros((4, 8))
    rows[0, [0, 4]] = np.array([1, -1]) / (size * SHAPE_SIGMA)
    rows[1, [1, 3]] = 1 / (size * SHAPE_SIGMA)
    rows[2, 6] = rows[3, 7] = 1 / PERSPECTIVE_SIGMA
    return rows


def _map(G: Matrix, points: Matrix) -> tuple[Matrix, Matrix]:
    """Return the mapped points (N, 2), and their derivatives by g11 ... g32, (N, 2, 8)."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        inverse = 1 / (points @ G[2, :2] + 1)
        mapped = (points @ G[:2, :2].T + G[:2, 2]) * inverse[:, None]
        # (x, y, 1) over the depth: the derivative by one row of G.
        row = np.column_stack([points, np.ones(len(points))]) * inverse[:, None]
        J = np.zeros((len(points), 2, 8))
        J[:, 0, 0:3] = J[:, 1, 3:6] = row
        J[:, :, 6:] = -mapped[:, :, None] * row[:, None, :2]
    return mapped, J
