"""Small bags whose every pixel is known, written as the course's flights are."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from rosbags.rosbag1 import Writer

from course_lib.offline_ros.messages import STORE, message_class
from course_lib.offline_ros.wire import serialize

NODES = Path(__file__).parent / "nodes"
START_NS = 1_600_000_000_000_000_000
FRAME_NS = 100_000_000


def frame(index: int) -> np.ndarray:
    """A textured 64x48 picture whose top left block tells its number."""
    rng = np.random.default_rng(index)
    picture = cv2.resize(rng.integers(0, 256, (6, 8, 3), dtype=np.uint8), (64, 48))
    picture[:16, :16] = index * 10
    return picture


def write_bag(path: Path, frames: list[np.ndarray], *, fmt: str = "jpeg") -> Path:
    """Write pictures, ten per second, as the course's flights are written."""
    compressed = message_class("sensor_msgs/CompressedImage")
    info = message_class("sensor_msgs/CameraInfo")
    with Writer(path) as writer:
        images = writer.add_connection(
            "/camera/rgb/image_raw/compressed", "sensor_msgs/msg/CompressedImage", typestore=STORE
        )
        infos = writer.add_connection(
            "/camera/rgb/camera_info", "sensor_msgs/msg/CameraInfo", typestore=STORE
        )
        for index, picture in enumerate(frames):
            stamp = START_NS + index * FRAME_NS
            message = compressed(format=fmt, data=cv2.imencode(".png", picture)[1].tobytes())
            message.header.stamp.set(*divmod(stamp, 10**9))
            message.header.frame_id = "camera"
            writer.write(images, stamp, serialize(message))
            message = info(height=48, width=64, K=[50.0, 0, 32, 0, 50, 24, 0, 0, 1])
            message.header.stamp.set(*divmod(stamp, 10**9))
            writer.write(infos, stamp, serialize(message))
    return path
