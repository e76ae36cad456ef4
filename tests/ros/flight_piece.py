"""A piece of the flight, raw as a camera publishes it, with what is true of it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from course_lib import camera, images
from course_lib.grading.outlines import expected_outline
from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.modules.cv_bridge import CvBridge
from course_lib.offline_ros.recorder import Recorder

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "solutions" / "unit4"
TOPIC = "/camera/rgb/image_raw"
SEEN = (44, 50, 56, 60, 64, 70, 76, 82)  # the whole well is in these frames
NOWHERE = (123, 126, 129)  # nothing of it in these


@dataclass(frozen=True)
class Piece:
    """A few frames of the flight.

    Attributes
    ----------
    bag : Path
        `sensor_msgs/Image`, 0.1 s apart.
    pictures : dict of int to ndarray
        By stamp, ns; the last is blank.
    expected : dict of int to (ndarray or None)
        By stamp: where the outline of `unit4/waterhole.png` belongs; None: nowhere.
    """

    bag: Path
    pictures: dict[int, np.ndarray]
    expected: dict[int, np.ndarray | None]


def make_piece(bag: Path) -> Piece:
    """Write a piece of the flight and what is true of it."""
    truth = images.truth("flight.bag")
    there = truth["frames"][truth["template"]["frame"]]["well"]["polygon"]
    with camera.open_camera("flight.bag") as flight:
        frames = dict(enumerate(islice(flight, max(NOWHERE) + 1)))
    shown = [(frames[number].image, truth["frames"][number]) for number in (*SEEN, *NOWHERE)]
    shown.append((np.full((480, 640, 3), 200, np.uint8), {"well": {"polygon": []}}))
    recorder = Recorder(bag)
    pictures, expected = {}, {}
    for number, (picture, record) in enumerate(shown):
        stamp = 1_760_000_000_000_000_000 + number * 100_000_000
        message = CvBridge().cv2_to_imgmsg(picture, "bgr8")
        message.header = message_class("std_msgs/Header")(seq=number, frame_id="camera")
        message.header.stamp.set(*divmod(stamp, 10**9))
        recorder.write_message(TOPIC, stamp, message)
        here = record["well"]["polygon"]
        pictures[stamp] = picture
        expected[stamp] = expected_outline(truth["template"]["rect"], there, here) if here else None
    recorder.close()
    assert [one is not None for one in expected.values()] == [True] * 8 + [False] * 4
    return Piece(bag, pictures, expected)


def outlines(messages: list[tuple[int, SimpleNamespace]]) -> dict[int, np.ndarray]:
    """Give what a corners topic carried: stamp → (4, 2), or (0, 2) for not found."""
    return {
        message.header.stamp.to_nsec(): np.array(
            [(p.x, p.y) for p in message.polygon.points]
        ).reshape(-1, 2)
        for _, message in messages
    }
