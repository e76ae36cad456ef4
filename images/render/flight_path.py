"""Where the drone flies and where its front camera looks: smooth paths through a few way points.

World axes: x east, y north, z up, metres; the well stands at the origin. No renderer is needed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FRAMES_PER_SECOND = 10

WayPoint = tuple[int, tuple[float, float, float], tuple[float, float, float], float]


@dataclass(frozen=True)
class Flight:
    """A path through way points.

    Attributes
    ----------
    name : str
        Of the bag, relative to the images' folder, without its extension.
    way_points : tuple of (frame, position, target, roll)
        Position of the camera and the point it looks at, metres; roll in degrees.
    template : (frame, (x, y, width, height)), optional
        The crop of the well that the course uses as its template.
    """

    name: str
    way_points: tuple[WayPoint, ...]
    template: tuple[int, tuple[int, int, int, int]] | None = None

    @property
    def length(self) -> int:
        """Number of frames."""
        return self.way_points[-1][0] + 1


# Towards the well, round it, a long look aside (the well leaves the frame), back, up and away.
MAIN = Flight(
    "flight",
    (
        (0, (-1.6, -7.4, 1.6), (0.5, 0.0, 1.0), 0),
        (45, (-0.7, -5.6, 1.5), (0.2, 0.0, 1.0), 2),
        (80, (0.3, -4.4, 1.5), (0.0, 0.0, 1.15), 0),
        (108, (0.9, -5.1, 1.9), (-0.4, 0.0, 0.9), -3),
        (132, (0.7, -5.7, 1.9), (-9.0, -2.0, 1.4), 2),
        (158, (-0.3, -6.0, 2.0), (0.3, 0.0, 0.9), 4),
        (188, (-1.3, -5.2, 2.5), (0.0, 0.0, 0.8), -2),
        (214, (0.1, -6.4, 2.0), (0.7, 0.0, 0.9), 0),
        (249, (0.6, -7.8, 1.5), (0.0, 0.5, 1.2), 1),
    ),
    template=(60, (194, 116, 243, 265)),
)

# Held out: other heights, other sides, other manoeuvres.
HELD_OUT = (
    Flight(
        "heldout/flight_a",
        (
            (0, (1.5, -6.6, 1.7), (-0.4, 0.0, 1.0), 0),
            (20, (0.9, -5.0, 1.5), (0.0, 0.0, 1.1), -2),
            (38, (0.2, -5.4, 2.1), (0.3, 0.0, 0.9), 3),
            (52, (-0.6, -6.0, 2.2), (7.5, -1.0, 1.2), 2),
            (69, (-1.2, -6.4, 1.8), (0.0, 0.0, 1.0), 0),
        ),
    ),
    Flight(
        "heldout/flight_b",
        (
            (0, (-1.2, -7.8, 1.4), (0.0, 0.0, 1.3), 0),
            (22, (-1.2, -5.9, 1.8), (0.2, 0.0, 1.0), 3),
            (42, (0.6, -4.9, 2.2), (0.0, 0.0, 0.9), -3),
            (58, (1.1, -6.0, 1.6), (-0.6, 0.0, 1.1), 0),
            (69, (1.3, -6.8, 1.5), (-7.5, 1.0, 1.3), 0),
        ),
    ),
)


def _through(times: NDArray[np.float64], values: NDArray[np.float64], count: int) -> NDArray:
    """Cubic Hermite curve through the way points, at rest at both ends."""
    slopes = np.zeros_like(values)
    slopes[1:-1] = (values[2:] - values[:-2]) / (times[2:] - times[:-2])[:, None]
    at = np.arange(count)
    piece = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(times) - 2)
    span = (times[piece + 1] - times[piece])[:, None]
    t = ((at - times[piece]) / span[:, 0])[:, None]
    return (
        (2 * t**3 - 3 * t**2 + 1) * values[piece]
        + (t**3 - 2 * t**2 + t) * span * slopes[piece]
        + (3 * t**2 - 2 * t**3) * values[piece + 1]
        + (t**3 - t**2) * span * slopes[piece + 1]
    )


def poses(flight: Flight) -> NDArray[np.float64]:
    """Return T_camera_from_world for every frame, OpenCV axes (x right, y down, z forward).

    Parameters
    ----------
    flight : Flight

    Returns
    -------
    ndarray of float64, shape (frames, 4, 4)
    """
    times = np.array([w[0] for w in flight.way_points], float)
    rows = np.array([[*w[1], *w[2], w[3]] for w in flight.way_points], float)
    path = _through(times, rows, flight.length)
    # A hovering drone is never quite still: a slow sway, a quicker tremble.
    rng = np.random.default_rng(len(flight.name))
    phase = rng.uniform(0, 2 * np.pi, (2, 7))
    seconds = np.arange(flight.length)[:, None] / FRAMES_PER_SECOND
    sway = np.sin(2 * np.pi * 0.4 * seconds + phase[0])
    tremble = np.sin(2 * np.pi * 1.7 * seconds + phase[1])
    path = path + sway * [0.04, 0.04, 0.03, 0.1, 0.1, 0.06, 0.8]
    path = path + tremble * [0.006, 0.006, 0.006, 0.025, 0.025, 0.02, 0.25]
    return np.array([_look(row[:3], row[3:6], np.radians(row[6])) for row in path])


def _look(position: NDArray, target: NDArray, roll: float) -> NDArray[np.float64]:
    forward = (target - position) / np.linalg.norm(target - position)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    c, s = np.cos(roll), np.sin(roll)
    T = np.eye(4)
    T[:3, :3] = [c * right + s * down, c * down - s * right, forward]
    T[:3, 3] = -T[:3, :3] @ position
    return T
