"""Frames from the simulated drone, one after the other for as long as one asks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_lib.camera.frames import CameraError, Frame, FrameSource

if TYPE_CHECKING:
    from collections.abc import Iterator


def is_drone(source: Any) -> bool:  # noqa: ANN401 (whatever somebody gives to open_camera)
    """Tell whether this is the word "drone" or a drone: what flies, sees and lets time pass."""
    return source == "drone" if isinstance(source, str) else hasattr(source, "command")


class DroneSource(FrameSource):
    """
    What the simulated drone sees, at a steady rate of its own time.

    Parameters
    ----------
    source : "drone" or Drone
        A drone of the caller's stays open when the source is closed.
    rate : float
        Frames per second.

    Raises
    ------
    CameraError
        The simulator cannot run here, or the rate is not positive.
    """

    def __init__(self, source: Any, *, rate: float) -> None:  # noqa: ANN401
        super().__init__("drone")
        if not 0 < rate < float("inf"):
            raise CameraError(f"rate must be a positive number of frames per second, got {rate}")
        self._own = isinstance(source, str)
        self._period = 1.0 / rate
        if not self._own:
            self.drone = source
            return
        # MuJoCo takes a second to load: only who flies waits for it.
        from course_lib.drone import Drone, RendererError  # noqa: PLC0415

        try:
            self.drone = Drone()
        except RendererError as error:
            raise CameraError(f'{error}. The recording "flight.bag" needs none of it') from error

    def _read(self) -> Iterator[Frame]:
        while True:
            yield self.drone.frame()
            self.drone.step(self._period)

    def _release(self) -> None:
        if self._own:
            self.drone.close()
