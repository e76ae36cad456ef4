"""How the drone moves: it follows velocity commands with some delay, and stops at what is solid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from course_lib.yard import backend
from course_lib.yard.eye import yard_model
from course_lib.yard.model import TIME_STEP

if TYPE_CHECKING:
    from numpy.typing import NDArray

LAG = 0.35  # seconds: after it, 63 % of a commanded change is done
TURN_LAG = 0.2
# Forward, left, up in m/s and turning in rad/s; beyond, a command is cut.
FASTEST = np.array([2.0, 2.0, 1.0, 1.5])
STRONGEST = np.array([4.0, 4.0, 4.0, 8.0])  # accelerations, m/s² and rad/s²


class Body:
    """The drone as one kilogram with four degrees of freedom.

    Parameters
    ----------
    position : (x, y, z), metres
    heading : float
        Radians from east, counter-clockwise.
    """

    def __init__(self, position: tuple[float, float, float], heading: float) -> None:
        self._mujoco, _ = backend.load()
        self._data = self._mujoco.MjData(yard_model())
        self._data.qpos[:] = [*position, heading]
        yard = yard_model()
        self._mujoco.mj_forward(yard, self._data)
        self._inertia = np.array([1.0, 1.0, 1.0, yard.body("drone").inertia[2]])
        self._left_over = 0.0

    @property
    def position(self) -> NDArray[np.float64]:
        """x, y, z in metres, shape (3,)."""
        return np.array(self._data.qpos[:3])

    @property
    def heading(self) -> float:
        """Radians from east, counter-clockwise."""
        return float(self._data.qpos[3])

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Forward, left, up in m/s and turning in rad/s, shape (4,)."""
        v = np.array(self._data.qvel)
        v[:2] = self._turned(v[:2], -self.heading)
        return v

    @staticmethod
    def _turned(xy: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
        c, s = np.cos(angle), np.sin(angle)
        return np.array([c * xy[0] - s * xy[1], s * xy[0] + c * xy[1]])

    def wanted_acceleration(self, command: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give what the flight controller asks of the motors, body axes, shape (4,)."""
        goal = np.clip(command, -FASTEST, FASTEST)
        lag = np.array([LAG, LAG, LAG, TURN_LAG])
        return np.asarray(np.clip((goal - self.velocity) / lag, -STRONGEST, STRONGEST))

    def move(self, command: NDArray[np.float64], seconds: float) -> None:
        """Follow a command for some time, in steps of 10 ms; what is left over counts next time.

        Parameters
        ----------
        command : ndarray, shape (4,)
            As `velocity`.
        seconds : float
        """
        self._left_over += seconds
        steps = int(self._left_over / TIME_STEP + 1e-6)
        self._left_over -= steps * TIME_STEP
        for _ in range(steps):
            push = self.wanted_acceleration(command)
            push[:2] = self._turned(push[:2], self.heading)
            self._data.qfrc_applied[:] = push * self._inertia
            self._mujoco.mj_step(yard_model(), self._data)
