"""The nodes that find the well, on real ROS and offline: where it is, and the same on both."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from flight_piece import PACKAGE, TOPIC, Piece, outlines

from course_lib.grading.outlines import outline_overlap
from course_lib.offline_ros import Recording, run_node
from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.modules.cv_bridge import CvBridge
from course_lib.offline_ros.recorder import Recorder
from course_lib.real_ros import run_launch

NODES = {"example4_5": "/object", "exercise4_2_2": "/waterhole"}
# Debian's OpenCV is 4.6, ours 5. Keypoints, descriptors and matches are the same bits in both. The
# homography is fitted in floating point by other code: measured 0.001 to 0.01 pixel apart where
# the well is found. 0.1 leaves room for another processor and is far below what anybody can see.
SAME_PIXELS = 0.1


@pytest.fixture(scope="module", params=NODES)
def name(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture(scope="module")
def on_ros(name: str, piece: Piece) -> Recording:
    return run_launch(PACKAGE, f"{name}.launch", bag=piece.bag)


def test_corners_are_where_the_well_is(name: str, on_ros: Recording, piece: Piece) -> None:
    found = outlines(on_ros[f"{NODES[name]}/corners"])
    assert list(found) == list(piece.expected)  # an answer to each frame, with its stamp
    for stamp, expected in piece.expected.items():
        if expected is None:
            assert len(found[stamp]) == 0
        else:
            assert outline_overlap(found[stamp], expected) > 0.5
    assert {message.header.frame_id for _, message in on_ros[f"{NODES[name]}/corners"]} == {
        "camera"
    }


def test_published_picture_is_the_frame_with_the_outline(
    name: str, on_ros: Recording, piece: Piece
) -> None:
    found = outlines(on_ros[f"{NODES[name]}/corners"])
    images = on_ros[f"{NODES[name]}/image"]
    assert len(images) == len(piece.pictures)
    for _, message in images:
        stamp = message.header.stamp.to_nsec()
        picture = CvBridge().imgmsg_to_cv2(message, "bgr8")
        changed = (picture != piece.pictures[stamp]).any(axis=2)
        assert changed.any() == (len(found[stamp]) > 0)
        assert (picture[changed] == (0, 255, 0)).all()


def test_offline_gives_the_same(name: str, on_ros: Recording, piece: Piece) -> None:
    offline = run_node(
        PACKAGE / "src" / f"{name}.py", bag=piece.bag, params={"template": "waterhole.png"}
    )
    assert list(offline) == list(on_ros)
    theirs, ours = (outlines(run[f"{NODES[name]}/corners"]) for run in (on_ros, offline))
    assert list(theirs) == list(ours)
    for stamp, outline in ours.items():
        assert theirs[stamp].shape == outline.shape
        np.testing.assert_allclose(theirs[stamp], outline, rtol=0, atol=SAME_PIXELS)
    assert [line.text for line in on_ros.log] == [line.text for line in offline.log]


def test_parameters_replace_those_of_the_launch_file(piece: Piece) -> None:
    few = run_launch(
        PACKAGE, "exercise4_2_2.launch", bag=piece.bag, max_frames=4, params={"match_count": 5}
    )
    # Ten matches must agree: five never do.
    assert [len(points) for points in outlines(few["/waterhole/corners"]).values()] == [0] * 4
    assert TOPIC in few.output


@pytest.mark.parametrize("node", NODES)
def test_broken_frames_are_left_out(node: str, tmp_path: Path) -> None:
    """One without pixels, one cut short, one in an unknown encoding, and a good one."""
    recorder = Recorder(tmp_path / "broken.bag")
    frames = [(0, 0, 0, "bgr8"), (48, 64, 100, "bgr8"), (48, 64, 9216, "x"), (48, 64, 9216, "bgr8")]
    for number, (height, width, size, encoding) in enumerate(frames):
        message = message_class("sensor_msgs/Image")(
            height=height, width=width, encoding=encoding, step=3 * width, data=bytes(size)
        )
        message.header.stamp.secs = number + 1
        recorder.write_message(TOPIC, (number + 1) * 10**9, message)
    recorder.close()
    recording = run_launch(PACKAGE, f"{node}.launch", bag=tmp_path / "broken.bag")
    assert list(outlines(recording[f"{NODES[node]}/corners"])) == [4 * 10**9]
    errors = [line for line in recording.log if line.level == "ERROR"]
    assert all(line.text.startswith("frame left out: ") for line in errors)
    assert len(errors) == 3
