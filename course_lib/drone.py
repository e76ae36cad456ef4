"""A simulated drone in the yard of the recorded flights: it obeys, sees, and tells the truth."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, Self

import cv2
import numpy as np

from course_lib.camera.frames import Frame
from course_lib.yard import world
from course_lib.yard.backend import RendererError, why_not
from course_lib.yard.eye import Eye
from course_lib.yard.flying import FASTEST, Body
from course_lib.yard.lens import SIZE, camera_matrix
from course_lib.yard.silhouette import silhouette

if TYPE_CHECKING:
    from types import TracebackType

    from numpy.typing import NDArray

__all__ = ["FASTEST", "Drone", "RendererError", "why_not"]

START = (-1.6, -7.4, 1.6)  # where the recorded flight begins
TILT = np.radians(7.5)  # the camera looks down by this, as it did on average
LEAN = 0.04  # radians for each m/s²: a drone leans into what it is about to do
NOISE = 2.2  # standard deviation of the sensor's noise, grey values
SIZE_OF_BANK = 4


@cache
def _well() -> NDArray[np.float64]:
    return world.triangles(list(world.well()))


class Drone:
    """
    A drone with a front camera that takes velocity commands, as over ``/cmd_vel``.

    Time passes only in :meth:`step`. The same seed and the same commands give the same flight.

    Parameters
    ----------
    seed : int
        Of its sway in the air and of the camera's noise.
    position : (x, y, z)
        Where it starts, metres: x east, y north, z up, the well at the origin.
    heading : float or None
        Radians from east, counter-clockwise; None looks at the well.
    command_timeout : float or None
        Hover when the last command is older than this many seconds, as real drones do; None obeys
        the last command for ever.

    Raises
    ------
    RendererError
        MuJoCo is missing, or there is nothing to draw with; the message says what to install.
        :func:`why_not` tells before.

    Examples
    --------
    >>> with Drone(seed=1) as drone:  # doctest: +SKIP
    ...     drone.command(vx=0.5, yaw_rate=0.1)
    ...     drone.step(0.1)
    ...     print(drone.frame())
    Frame(stamp_ns=100000000, image 640 x 480, truth known)
    """

    def __init__(
        self,
        seed: int = 0,
        *,
        position: tuple[float, float, float] = START,
        heading: float | None = None,
        command_timeout: float | None = None,
    ) -> None:
        rng = np.random.default_rng(seed)
        if heading is None:
            heading = float(np.arctan2(-position[1], -position[0]))
        self._eye = Eye()
        self._body = Body(position, heading)
        self._timeout = command_timeout
        self._command = np.zeros(4)
        self._commanded_ns = 0
        self._now_ns = 0
        self._lean = np.zeros(2)
        self._phases = rng.uniform(0, 2 * np.pi, (2, 6))
        grains = NOISE * rng.standard_normal((SIZE_OF_BANK, 480, 640, 3), np.float32)
        self._bank = np.rint(grains).astype(np.int8)

    def command(
        self, vx: float = 0.0, vy: float = 0.0, vz: float = 0.0, yaw_rate: float = 0.0
    ) -> None:
        """
        Set the velocity to follow, in the drone's own axes, as ``geometry_msgs/Twist`` has them.

        Parameters
        ----------
        vx, vy, vz : float
            Forward, left, up, m/s; cut at 2, 2 and 1.
        yaw_rate : float
            Turning left, rad/s; cut at 1.5.

        Raises
        ------
        ValueError
            Not a finite number.
        """
        wanted = np.array([vx, vy, vz, yaw_rate], np.float64)
        if not np.isfinite(wanted).all():
            raise ValueError(f"a velocity must be a finite number, got {wanted.tolist()}")
        self._command = wanted
        self._commanded_ns = self._now_ns

    def step(self, dt: float) -> None:
        """
        Let time pass.

        Parameters
        ----------
        dt : float
            Seconds, not negative.

        Raises
        ------
        ValueError
            Negative, not a number, or more than an hour.
        """
        if not 0 <= dt <= 3600:
            raise ValueError(f"dt must be from 0 to 3600 seconds, got {dt}")
        end_ns = self._now_ns + round(dt * 1e9)
        if self._timeout is not None:
            over_ns = self._commanded_ns + round(self._timeout * 1e9)
            if self._now_ns < over_ns < end_ns:
                self._advance(over_ns)
            if over_ns <= self._now_ns:
                self._command = np.zeros(4)
        self._advance(end_ns)

    def _advance(self, until_ns: int) -> None:
        seconds = (until_ns - self._now_ns) / 1e9
        self._body.move(self._command, seconds)
        push = self._body.wanted_acceleration(self._command)
        # Leaning takes a moment, too.
        self._lean += (push[:2] - self._lean) * (1 - np.exp(-seconds / 0.15))
        self._now_ns = until_ns

    @property
    def now_ns(self) -> int:
        """Simulated time since the start, nanoseconds."""
        return self._now_ns

    @property
    def position(self) -> NDArray[np.float64]:
        """Where it is: x, y, z in metres, shape (3,), without its sway."""
        return self._body.position

    @property
    def heading(self) -> float:
        """Where it faces: radians from east, counter-clockwise."""
        return self._body.heading

    @property
    def velocity(self) -> NDArray[np.float64]:
        """How it moves: forward, left, up in m/s and turning left in rad/s, shape (4,)."""
        return self._body.velocity

    @property
    def K(self) -> NDArray[np.float64]:  # noqa: N802 (the field's own capital)
        """Camera matrix in pixels, shape (3, 3)."""
        return camera_matrix()

    @property
    def T_camera_from_world(self) -> NDArray[np.float64]:  # noqa: N802
        """Pose of the camera now, shape (4, 4), OpenCV's axes: x right, y down, z forward."""
        seconds = self._now_ns / 1e9
        sway = np.sin(2 * np.pi * 0.4 * seconds + self._phases[0])
        sway = sway + 0.2 * np.sin(2 * np.pi * 1.7 * seconds + self._phases[1])
        position = self.position + 0.02 * sway[:3]
        yaw, pitch, roll = np.radians([0.25, 0.25, 0.4]) * sway[3:]
        yaw += self.heading
        pitch += TILT + LEAN * self._lean[0]
        roll += -LEAN * self._lean[1]
        cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
        forward = np.array([cy * cp, sy * cp, -sp])
        right = np.array([sy, -cy, 0.0])
        down = np.cross(forward, right)
        c, s = np.cos(roll), np.sin(roll)
        T = np.eye(4)
        T[:3, :3] = [c * right + s * down, c * down - s * right, forward]
        T[:3, 3] = -T[:3, :3] @ position
        return T

    def frame(self) -> Frame:
        """
        Take a picture.

        Returns
        -------
        Frame
            640 × 480, stamped with the simulated time. Its truth has the fields of a recorded
            flight's (``stamp_ns``, ``T_camera_from_world``, ``well`` with ``polygon`` and
            ``visible``) and ``camera`` with ``K``.

        Raises
        ------
        ValueError
            The drone is closed.
        """
        T = self.T_camera_from_world
        image = self._exposed(self._eye.look(T))
        polygon, visible = silhouette(_well(), self.K, T, SIZE)
        truth: dict[str, Any] = {
            "stamp_ns": self._now_ns,
            "camera": {"K": self.K.tolist()},
            "T_camera_from_world": T.tolist(),
            "well": {"polygon": polygon.astype(int).tolist(), "visible": round(visible, 4)},
        }
        return Frame(self._now_ns, image, truth)

    def _exposed(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Blur and noise of the recorded flights' camera, at a fraction of the cost."""
        soft = cv2.GaussianBlur(image, (3, 3), 0.8)
        # Noise of this very moment: the same time shows the same grains.
        rng = np.random.default_rng((self._now_ns, int(1e6 * self._phases[0, 0])))
        noise = self._bank[rng.integers(SIZE_OF_BANK)]
        if rng.integers(2):
            noise = noise[::-1]
        if rng.integers(2):
            noise = noise[:, ::-1]
        return np.asarray(cv2.add(soft, noise, dtype=cv2.CV_8U), np.uint8)

    def close(self) -> None:
        """Free the renderer; no more frames can be taken."""
        self._eye.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
