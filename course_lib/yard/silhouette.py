"""The outline of an object in a picture, from its triangles and the camera: no renderer involved.

Truth must not come from the picture it is meant to judge.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

NEAR = 0.05
FRACTION_BITS = 6


def _clipped(triangle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cut off what lies behind the camera; camera axes, shape (K, 3)."""
    kept = []
    for a, b in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
        if a[2] > NEAR:
            kept.append(a)
        if (a[2] > NEAR) != (b[2] > NEAR):
            kept.append(a + (NEAR - a[2]) / (b[2] - a[2]) * (b - a))
    return np.array(kept).reshape(-1, 3)


def silhouette(
    triangles: NDArray[np.float64],
    K: NDArray[np.float64],
    T_camera_from_world: NDArray[np.float64],
    size: tuple[int, int],
) -> tuple[NDArray[np.float64], float]:
    """Return the object's outline in the frame and how much of it the frame holds.

    Parameters
    ----------
    triangles : ndarray, shape (M, 3, 3)
        World points, metres.
    K : ndarray, shape (3, 3)
    T_camera_from_world : ndarray, shape (4, 4)
        OpenCV axes.
    size : (width, height)

    Returns
    -------
    polygon : ndarray, shape (N, 2)
        Outer outline of the largest visible piece, clipped to the frame; empty when out of view.
        Things standing in front are not subtracted.
    visible : float
        Share of the whole silhouette's area that lies within the frame, 0 to 1.
    """
    width, height = size
    # The whole silhouette is measured on a canvas of three by three frames, ours in the middle.
    canvas = np.zeros((3 * height, 3 * width), np.uint8)
    local = triangles @ T_camera_from_world[:3, :3].T + T_camera_from_world[:3, 3]
    ahead = (local[:, :, 2] > NEAR).all(axis=1)
    pieces = [_clipped(triangle) for triangle in local[~ahead]]
    polygons = [local[ahead], *(piece[None] for piece in pieces if len(piece) >= 3)]
    for corners in polygons:
        pixels = corners @ K.T
        xy = pixels[..., :2] / pixels[..., 2:] + (width, height)
        xy = np.clip(xy, -4 * width, 8 * width)
        for fixed in np.rint(xy * 2**FRACTION_BITS).astype(np.int32):
            cv2.fillConvexPoly(canvas, fixed, 255, cv2.LINE_8, FRACTION_BITS)
    frame = np.ascontiguousarray(canvas[height : 2 * height, width : 2 * width])
    whole = np.count_nonzero(canvas)
    visible = np.count_nonzero(frame) / whole if whole else 0.0
    contours, _ = cv2.findContours(frame, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    if not contours:
        return np.zeros((0, 2)), 0.0
    largest = max(contours, key=cv2.contourArea)
    return cv2.approxPolyDP(largest, 0.8, closed=True).reshape(-1, 2).astype(float), visible
