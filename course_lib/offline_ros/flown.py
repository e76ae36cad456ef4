"""Feeds a node from the simulated drone, which obeys what the node publishes on `/cmd_vel`."""

from __future__ import annotations

from collections import deque
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.offline_ros.bag import Arrival
from course_lib.offline_ros.errors import BagError
from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.source import Source
from course_lib.offline_ros.times import Time
from course_lib.offline_ros.wire import deserialize

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator

    from course_lib.camera import Frame

DRONE = "drone"  # what stands for it where a bag's name is expected
IMAGE, INFO, COMMANDS = "/camera/rgb/image_raw", "/camera/rgb/camera_info", "/cmd_vel"
TOPICS = {IMAGE: "sensor_msgs/Image", INFO: "sensor_msgs/CameraInfo"}
FRAME_ID = "camera_rgb_optical_frame"
START_NS = 1_760_000_000_000_000_000  # as in the recorded flights
SECONDS = 30.0  # a flight ends, unlike a robot's camera
RATE = 10.0
TIMEOUT = 0.5  # seconds without a command until it hovers


class DroneSource(Source):
    """The camera of a simulated drone, which listens to `/cmd_vel`.

    A picture is taken when the node gets it, after all commands that it gave before that moment
    and none that it gave later.

    Parameters
    ----------
    topics : collection of str, optional
        Play only these topics. Default: all.
    max_frames : int, optional
        Stop after this many pictures.
    seconds : float, optional
        How long the flight lasts.
    heading : float, optional
        Degrees from east, counter-clockwise. Default: towards the well.

    Raises
    ------
    BagError
        When the simulator cannot run here, or there is no such topic.
    """

    def __init__(
        self,
        *,
        topics: Collection[str] | None = None,
        max_frames: int | None = None,
        seconds: float | None = None,
        heading: float | None = None,
    ) -> None:
        if missing := sorted(set(topics or ()) - set(TOPICS)):
            msg = f"the drone has no topic {', '.join(missing)}; it has {', '.join(TOPICS)}"
            raise BagError(msg)
        # MuJoCo takes a second to load: only who flies waits for it.
        from math import radians  # noqa: PLC0415

        from course_lib.drone import Drone, RendererError  # noqa: PLC0415

        facing = None if heading is None else radians(heading)
        try:
            self._drone = Drone(heading=facing, command_timeout=TIMEOUT)
        except RendererError as error:
            raise BagError(str(error)) from error
        self.path = Path(DRONE)
        self.topics = {t: kind for t, kind in TOPICS.items() if topics is None or t in topics}
        self.camera = IMAGE if IMAGE in self.topics else None
        self.rate = RATE
        self.start_ns = START_NS
        count = int((seconds or SECONDS) * RATE) + 1
        self.frame_count = count if max_frames is None else min(count, max_frames)
        self._commands: deque[tuple[int, Any]] = deque()

    def __iter__(self) -> Iterator[Arrival]:
        for number in range(self.frame_count):
            stamp_ns = START_NS + round(number * 1e9 / RATE)
            loads = {INFO: self._info, IMAGE: self._image}
            for topic, load in loads.items():
                if topic in self.topics:
                    yield Arrival(stamp_ns, topic, TOPICS[topic], _once(load, stamp_ns, number))

    def hear(self, topic: str, msgtype: str, stamp_ns: int, raw: bytes) -> None:
        """Put a command on `/cmd_vel` in the queue."""
        if topic == COMMANDS and msgtype == "geometry_msgs/Twist":
            self._commands.append((stamp_ns, deserialize(raw, msgtype)))

    def _fly_to(self, stamp_ns: int) -> None:
        while self._commands and self._commands[0][0] <= stamp_ns:
            given_ns, twist = self._commands.popleft()
            self._pass_time(given_ns)
            v = twist.linear
            self._drone.command(v.x, v.y, v.z, twist.angular.z)
        self._pass_time(stamp_ns)

    def _pass_time(self, stamp_ns: int) -> None:
        left_ns = stamp_ns - START_NS - self._drone.now_ns
        self._drone.step(max(0, left_ns) / 1e9)

    def _header(self, stamp_ns: int, number: int) -> Any:  # noqa: ANN401 (made at run time)
        header = message_class("std_msgs/Header")
        return header(seq=number, stamp=Time.from_nsec(stamp_ns), frame_id=FRAME_ID)

    def _image(self, stamp_ns: int, number: int) -> Any:  # noqa: ANN401
        self._fly_to(stamp_ns)
        frame: Frame = self._drone.frame()
        height, width = frame.image.shape[:2]
        return message_class(TOPICS[IMAGE])(
            header=self._header(stamp_ns, number),
            height=height,
            width=width,
            encoding="bgr8",
            step=3 * width,
            data=frame.image.tobytes(),
        )

    def _info(self, stamp_ns: int, number: int) -> Any:  # noqa: ANN401
        K = self._drone.K
        return message_class(TOPICS[INFO])(
            header=self._header(stamp_ns, number),
            height=480,
            width=640,
            distortion_model="plumb_bob",
            D=[0.0] * 5,
            K=K.ravel().tolist(),
            R=[1.0, 0, 0, 0, 1, 0, 0, 0, 1],
            P=[K[0, 0], 0, K[0, 2], 0, 0, K[1, 1], K[1, 2], 0, 0, 0, 1, 0],
        )

    def close(self) -> None:
        """Free the drone's renderer."""
        self._drone.close()


def _once(load: Callable[[int, int], Any], stamp_ns: int, number: int) -> Callable[[], Any]:
    # A picture is taken once, however many subscribers there are.
    return lru_cache(maxsize=1)(lambda: load(stamp_ns, number))
