"""Estimate a homography from matches, and apply it."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

METHODS = {
    name: int(getattr(cv2, name))
    for name in (
        "RANSAC",
        "LMEDS",
        "RHO",
        "USAC_DEFAULT",
        "USAC_FAST",
        "USAC_ACCURATE",
        "USAC_MAGSAC",
        "USAC_PROSAC",
    )
}

Points = NDArray[np.floating]
Matrix = NDArray[np.float64]


def method_code(method: str | int) -> int:
    """
    Return OpenCV's code of a robust estimator.

    Raises
    ------
    ValueError
        Unknown name or code.
    """
    if isinstance(method, str) and method.upper() in METHODS:
        return METHODS[method.upper()]
    if not isinstance(method, str) and method in METHODS.values():
        return int(method)
    raise ValueError(f"unknown method {method!r}; choose from {', '.join(METHODS)}")


def estimate(
    template_points: Points,
    scene_points: Points,
    *,
    method: int,
    threshold: float,
    max_iterations: int = 2000,
    confidence: float = 0.999,
    seed: int = 0,
) -> Matrix | None:
    """
    Fit H_scene_from_template to point pairs, best pair first, with outliers among them.

    Parameters
    ----------
    template_points, scene_points : ndarray, shape (N, 2)
        Corresponding (x, y), the most trusted first (USAC_PROSAC draws from the front).
    method : int
        One of ``METHODS``.
    threshold : float
        How far, in scene pixels, a pair may be off and still be an inlier.
    max_iterations : int
        The most minimal samples to try.
    confidence : float
        Stop early when the chance of having missed the best sample is below 1 - confidence.
    seed : int
        OpenCV's generators start from a constant, so a different draw comes from a different
        order of the pairs. 0 keeps the order; so does USAC_PROSAC, to which it means something.

    Returns
    -------
    ndarray of float64, shape (3, 3), with H[2, 2] = 1; or None
        None when no homography was found.
    """
    if len(template_points) < 4:
        return None
    order = np.arange(len(template_points))
    if seed and method != cv2.USAC_PROSAC:
        order = np.random.default_rng(seed).permutation(len(order))
    try:
        found, _ = cv2.findHomography(
            template_points[order].astype(np.float32),
            scene_points[order].astype(np.float32),
            method,
            threshold,
            maxIters=max_iterations,
            confidence=confidence,
        )
    except cv2.error:
        # Some estimators raise on degenerate points where others return None.
        return None
    H = None if found is None else np.asarray(found, np.float64)
    if H is None or H.shape != (3, 3) or not np.isfinite(H).all() or abs(H[2, 2]) < 1e-12:
        return None
    return np.asarray(H / H[2, 2], np.float64)


def project(H: Matrix, points: NDArray[np.floating]) -> Matrix:
    """
    Apply a homography to points.

    Parameters
    ----------
    H : ndarray, shape (3, 3)
    points : ndarray, shape (N, 2)

    Returns
    -------
    ndarray of float64, shape (N, 2)
        Infinite or NaN where a point is sent to infinity.
    """
    mapped = points @ H[:, :2].T + H[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(mapped[:, :2] / mapped[:, 2:], np.float64)


def reprojection_errors(H: Matrix, source: Points, target: Points) -> NDArray[np.float64]:
    """Return, for each pair, the distance in pixels between H(source) and target, shape (N,)."""
    errors = np.linalg.norm(project(H, source) - target, axis=1)
    return np.asarray(np.nan_to_num(errors, nan=np.inf), np.float64)


def jacobians(H: Matrix, points: Points) -> Matrix:
    """
    Return what a homography does to a small patch around each point.

    Parameters
    ----------
    H : ndarray, shape (3, 3)
    points : ndarray, shape (N, 2)

    Returns
    -------
    ndarray of float64, shape (N, 2, 2)
        Derivatives of the mapped (x, y) by the original (x, y).
    """
    depths = points @ H[2, :2] + H[2, 2]
    mapped = project(H, points)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(
            (H[None, :2, :2] - mapped[:, :, None] * H[None, None, 2, :2]) / depths[:, None, None],
            np.float64,
        )


def template_corners(size: tuple[int, int]) -> NDArray[np.float32]:
    """Return the centres of a picture's corner pixels: TL, BL, BR, TR; float32 (4, 2)."""
    right, bottom = size[0] - 1, size[1] - 1
    return np.array([[0, 0], [0, bottom], [right, bottom], [right, 0]], np.float32)
