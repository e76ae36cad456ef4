"""Sun and sky on the yard, worked out once: nothing in it moves, and nothing in it shines.

A real-time renderer would spend most of its time on shadows. The light that falls on each facet is
computed here instead, from height maps seen along the sun's direction and a few of the sky's, in
the linear units of the recorded flights (`images/render/yard.py`), and becomes part of the colours.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from course_lib.yard.world import SKY_HORIZON, SKY_ZENITH, SUN_DIRECTION

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Points = NDArray[np.float64]

GAMMA = 2.2
SUN_BGR = 3.2 / np.pi * np.array([0.86, 0.95, 1.0])
# The lawn sends some of its light up again, and what is in the shade sends some to its neighbours.
BOUNCE_BGR = np.array([0.10, 0.32, 0.20])
SHADE_BGR = np.array([0.20, 0.26, 0.20])
REACH = 16.0  # metres from the well within which things throw shadows
BIAS = 0.06  # metres; a surface does not shade itself


class HeightMap:
    """How far up along a direction the yard reaches, on a grid across that direction.

    Parameters
    ----------
    triangles : ndarray, shape (M, 3, 3)
        What throws shadows, metres.
    direction : sequence of 3 floats
        Towards the light.
    texel : float
        Size of a grid cell, metres.
    """

    def __init__(self, triangles: Points, direction: Sequence[float], texel: float) -> None:
        up = np.asarray(direction, float) / np.linalg.norm(direction)
        across = np.cross([0.0, 1.0, 0.0], up)
        across /= np.linalg.norm(across)
        self._axes = np.stack([across, np.cross(up, across), up])
        self._texel = texel
        self._count = int(2 * REACH / texel)
        self._top = np.full((self._count, self._count), -np.inf)
        near = np.linalg.norm(triangles.mean(axis=1), axis=1) < REACH
        sides = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
        local = triangles[near & (sides > 2 * texel)] @ self._axes.T
        for triangle in local:
            self._cover(triangle)

    def _cover(self, triangle: Points) -> None:
        """Raise the cells under a facet to its height, which is a plane over the grid."""
        corners = triangle[:, :2] / self._texel + self._count // 2
        low = np.clip(np.floor(corners.min(axis=0)), 0, self._count).astype(int)
        high = np.clip(np.ceil(corners.max(axis=0)) + 1, 0, self._count).astype(int)
        (ax, ay), (bx, by) = corners[1] - corners[0], corners[2] - corners[0]
        area = ax * by - ay * bx
        if abs(area) < 1e-9 or (low >= high).any():
            return
        x = np.arange(low[0], high[0]) - corners[0, 0]
        y = np.arange(low[1], high[1])[:, None] - corners[0, 1]
        u, v = (x * by - y * bx) / area, (y * ax - x * ay) / area
        # A little more than the facet, so that neighbours leave no gap and small ones are not lost.
        margin = 0.5 * (abs(ax) + abs(ay) + abs(bx) + abs(by)) / abs(area)
        margin = min(margin, 0.5)
        inside = (u > -margin) & (v > -margin) & (u + v < 1 + margin)
        u, v = np.clip(u, 0, 1), np.clip(v, 0, 1)
        z = triangle[0, 2] + u * (triangle[1, 2] - triangle[0, 2])
        z = z + v * (triangle[2, 2] - triangle[0, 2])
        held = self._top[low[1] : high[1], low[0] : high[0]]
        np.maximum(held, np.where(inside, z, -np.inf), out=held)

    def _cells(self, local: Points) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        column, row = np.rint(local[:, :2].T / self._texel).astype(np.intp) + self._count // 2
        held = (column >= 0) & (column < self._count) & (row >= 0) & (row < self._count)
        return np.where(held, row * self._count + column, 0), held

    def reached(self, points: Points) -> NDArray[np.float64]:
        """Tell how much of the light reaches each point, 0 to 1: softened by a cell's width.

        Parameters
        ----------
        points : ndarray, shape (N, 3)

        Returns
        -------
        ndarray, shape (N,)
        """
        local = points @ self._axes.T
        share = np.zeros(len(points))
        for dx, dy in ((0.0, 0.0), (1, 0), (-1, 0), (0, 1), (0, -1)):
            cells, held = self._cells(local + np.array([dx, dy, 0]) * self._texel)
            share += ~held | (self._top.ravel()[cells] < local[:, 2] + BIAS)
        return share / 5


def sky(directions: Points) -> NDArray[np.float64]:
    """Return the sky's radiance, linear BGR, shape (N, 3), towards unit directions (N, 3)."""
    horizon, zenith = (np.array(c) / 255 for c in (SKY_HORIZON, SKY_ZENITH))
    height = np.clip(directions[:, 2] / 0.6, 0, 1)[:, None]
    return np.asarray(horizon**GAMMA * (1 - height) + zenith**GAMMA * height)


class Light:
    """The light in a yard.

    Parameters
    ----------
    triangles : ndarray, shape (M, 3, 3)
        All that throws shadows, metres.
    """

    def __init__(self, triangles: Points) -> None:
        self.sun_direction = np.array(SUN_DIRECTION) / np.linalg.norm(SUN_DIRECTION)
        self._sun = HeightMap(triangles, SUN_DIRECTION, 0.05)
        # Directions over the sky of equal weight, on a spiral.
        count = 14
        heights = (np.arange(count) + 0.5) / count
        turns = np.arange(count) * np.pi * (3 - np.sqrt(5))
        flat = np.sqrt(1 - heights**2)
        self._ways = np.stack([flat * np.cos(turns), flat * np.sin(turns), heights], axis=1)
        self._skies = [HeightMap(triangles, way, 0.2) for way in self._ways]

    def falling_on(
        self, points: Points, normals: Points, *, shadows: bool = True
    ) -> NDArray[np.float64]:
        """Return what a white surface would send to the eye.

        Parameters
        ----------
        points, normals : ndarray, shape (N, 3)
            Metres; unit vectors.
        shadows : bool
            Without them, all is in the open.

        Returns
        -------
        ndarray, shape (N, 3)
            Linear BGR; 1 is white.
        """
        lifted = points + 0.01 * normals
        facing = np.clip(normals @ self.sun_direction, 0, None)
        seen = self._sun.reached(lifted) if shadows else 1.0
        total = (facing * seen)[:, None] * SUN_BGR
        for way, radiance, above in zip(self._ways, sky(self._ways), self._skies, strict=True):
            weight = 2 * np.clip(normals @ way, 0, None) / len(self._ways)
            seen = above.reached(lifted) if shadows else 1.0
            lit = np.broadcast_to(seen, weight.shape)[:, None]
            total = total + weight[:, None] * (lit * radiance + (1 - lit) * SHADE_BGR)
        # Towards the lawn, and the less the higher above it: clouds are not green.
        near = np.clip(0.5 - 0.5 * normals[:, 2:], 0, 1) * np.exp(-points[:, 2:] / 8)
        return np.asarray(total + near * BOUNCE_BGR)


def tint(light: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn linear light into the factor by which it changes a stored (sRGB) colour."""
    return np.asarray(np.maximum(light, 0) ** (1 / GAMMA))
