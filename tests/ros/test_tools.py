"""ROS's own tools, as a person uses them: roslaunch, rosbag play, rostopic, on one master."""

from __future__ import annotations

import re
import time
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from flight_piece import TOPIC, Piece

from course_lib import images
from course_lib.checks.exercise_4_1 import shelf_corners
from course_lib.grading.outlines import corner_error, outline_overlap
from course_lib.real_ros import Ros


def await_nodes(ros: Ros, topic: str, *, publishers: int = 0, subscribers: int = 0) -> None:
    """Wait until so many nodes publish on a topic and subscribe to it."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        sending, listening = ros.nodes_on(topic)
        if len(sending) >= publishers and len(listening) >= subscribers:
            return
        time.sleep(0.05)
    raise AssertionError(f"{topic}: {ros.nodes_on(topic)}")


def test_flight_played_by_rosbag_is_followed(ros: Ros, piece: Piece) -> None:
    finder = ros.start("roslaunch", "unit4", "exercise4_2_2.launch")
    await_nodes(ros, TOPIC, subscribers=1)
    await_nodes(ros, "/waterhole/corners", publishers=1)
    echo = ros.start("rostopic", "echo", "/waterhole/corners")
    await_nodes(ros, "/waterhole/corners", publishers=1, subscribers=1)
    ros.run("rosbag", "play", "--quiet", "--rate=0.3", "--delay=1", str(piece.bag))
    echo.end()
    finder.end()
    messages = [message for message in yaml.safe_load_all(echo.output) if message]
    # This player waits for nobody, so a busy machine loses frames; what is answered is right.
    assert len(messages) >= 4
    for message in messages:
        stamp = message["header"]["stamp"]
        expected = piece.expected[stamp["secs"] * 10**9 + stamp["nsecs"]]
        found = np.array([(p["x"], p["y"]) for p in message["polygon"]["points"]])
        if expected is None:
            assert len(found) == 0
        else:
            assert outline_overlap(found, expected) > 0.5


def test_picture_is_taken_from_the_stream(ros: Ros, piece: Piece, tmp_path: Path) -> None:
    file = tmp_path / "frame.png"
    taker = ros.start("roslaunch", "unit4", "exercise4_2_1.launch", f"output:={file}")
    await_nodes(ros, TOPIC, subscribers=1)
    ros.run("rosbag", "play", "--quiet", "--delay=1", str(piece.bag))
    assert taker.wait(60) == 0
    assert f"saved {file}, 640 x 480" in taker.output
    assert "has finished cleanly" in taker.output
    taken = cv2.imread(str(file))
    assert any(np.array_equal(taken, frame) for frame in piece.pictures.values())


def test_mug_is_found_by_the_script_as_a_node(ros: Ros, tmp_path: Path) -> None:
    finder = ros.start("roslaunch", "unit4", "exercise4_1.launch", f"out:={tmp_path}")
    assert finder.wait(60) == 0
    assert "has finished cleanly" in finder.output
    corners = yaml.safe_load(re.search(r"mug: (\[.*\])", finder.output)[1])
    # The print is bent round the mug: no homography fits it to a pixel.
    assert corner_error(corners, shelf_corners()) < 20
    found = cv2.imread(str(tmp_path / "exercise4_1_found.png"))
    assert found.shape == (400, 600, 3)
    assert (found == (0, 200, 0)).all(axis=2).sum() > 500
    assert (tmp_path / "exercise4_1_matches.png").is_file()
    assert (tmp_path / "exercise4_1_keypoints.png").is_file()


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (["ROS.png", "ROS2.png"], 0, "mug: [["),
        (["ROS.png", "peppers.png", "--show"], 1, "mug: not found"),
        (["ROS.png", "no.png"], 2, "there is no picture"),
    ],
)
def test_the_same_file_is_a_plain_script(
    ros: Ros, tmp_path: Path, arguments: list[str], status: int, words: str
) -> None:
    script = Path(__file__).parents[2] / "solutions" / "unit4" / "src" / "exercise4_1.py"
    files = [str(images.path("ROS.png").parent / a) if "." in a else a for a in arguments]
    run = ros.start(str(script), *files, "--out", str(tmp_path))
    assert run.wait(60) == status
    assert words in run.output
