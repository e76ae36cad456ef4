"""The nodes of Exercise 4.2 on frames of the recorded flight, judged by its truth."""

from __future__ import annotations

import re
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
import pytest
from synthetic_bag import FRAME_NS, START_NS, write_bag

from course_lib import camera, images
from course_lib.grading.outlines import expected_outline, outline_overlap
from course_lib.offline_ros import NodeError, run_node
from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.modules.cv_bridge import CvBridge
from course_lib.offline_ros.recorder import Recorder

UNIT4 = Path(__file__).resolve().parents[3] / "solutions" / "unit4"
TAKES, FINDS = (UNIT4 / "src" / f"exercise4_2_{number}.py" for number in (1, 2))
TRUTH = images.truth("flight.bag")
# The whole well is in the first three, none of it in the others; last comes a blank wall.
WHOLE, ABSENT = (0, 35, 60), (123, 129)


@pytest.fixture(scope="module")
def frames() -> list[np.ndarray]:
    with camera.open_camera("flight.bag") as flight:
        seen = [frame.image for frame in islice(flight, max(ABSENT) + 1)]
    return [*(seen[number] for number in WHOLE + ABSENT), np.full_like(seen[0], 200)]


@pytest.fixture(scope="module")
def bag(frames: list[np.ndarray], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_bag(tmp_path_factory.mktemp("flight") / "piece.bag", frames)


def bag_with_a_broken_frame(path: Path, frame: np.ndarray) -> Path:
    image = message_class("sensor_msgs/Image")
    broken = image(height=480, width=640, encoding="bgr8", step=1920, data=b"cut short")
    recorder = Recorder(path)
    for number, message in enumerate((broken, CvBridge().cv2_to_imgmsg(frame, "bgr8"))):
        stamp = START_NS + number * FRAME_NS
        message.header.stamp.set(*divmod(stamp, 10**9))
        recorder.write_message("/camera/rgb/image_raw", stamp, message)
    recorder.close()
    return path


# ----- the node that finds the waterhole


def test_outline_lies_on_the_waterhole_and_nowhere_else(bag: Path) -> None:
    recording = run_node(FINDS, bag=bag)
    corners, pictures = recording["/waterhole/corners"], recording["/waterhole/image"]
    assert len(corners) == len(pictures) == len(WHOLE) + len(ABSENT) + 1
    wells = [TRUTH["frames"][n]["well"]["polygon"] for n in WHOLE]
    there = TRUTH["frames"][TRUTH["template"]["frame"]]["well"]["polygon"]
    for i, ((stamp, polygon), (_, picture)) in enumerate(zip(corners, pictures, strict=True)):
        assert polygon.header.stamp.to_nsec() == picture.header.stamp.to_nsec() == stamp
        assert stamp == START_NS + i * FRAME_NS
        assert polygon.header.frame_id == "camera"
        found = np.array([(p.x, p.y) for p in polygon.polygon.points])
        green = (CvBridge().imgmsg_to_cv2(picture, "bgr8") == (0, 255, 0)).all(axis=2).sum()
        if i < len(WHOLE):
            expected = expected_outline(TRUTH["template"]["rect"], there, wells[i])
            assert outline_overlap(found, expected) > 0.6
            assert green > 1000
        else:
            assert len(found) == 0
            assert green < 50


def test_frame_cut_short_is_left_out_and_the_next_is_searched(
    tmp_path: Path, frames: list[np.ndarray]
) -> None:
    recording = run_node(FINDS, bag=bag_with_a_broken_frame(tmp_path / "a.bag", frames[2]))
    [(_, polygon)] = recording["/waterhole/corners"]
    assert len(polygon.polygon.points) == 4
    assert any(line.text.startswith("frame left out: ") for line in recording.log)


def test_parameters_are_obeyed(bag: Path, frames: list[np.ndarray], tmp_path: Path) -> None:
    # Ten points must agree: of nine, they never do.
    recording = run_node(FINDS, bag=bag, params={"match_count": 9}, max_frames=3)
    assert all(not m.polygon.points for _, m in recording["/waterhole/corners"])
    blank = tmp_path / "blank.png"
    cv2.imwrite(str(blank), frames[-1])
    recording = run_node(FINDS, bag=bag, params={"template": str(blank)}, max_frames=3)
    assert all(not m.polygon.points for _, m in recording["/waterhole/corners"])


def test_missing_template_is_named_with_the_fix(bag: Path) -> None:
    with pytest.raises(NodeError, match=r"no template 'none\.png' in .*saves it as unit4/water"):
        run_node(FINDS, bag=bag, params={"template": "none.png"}, max_frames=1)


# ----- the node that takes a picture


def test_saved_picture_is_the_frame(tmp_path: Path, bag: Path, frames: list[np.ndarray]) -> None:
    for delay, number in ((0, 0), (0.25, 3)):
        file = tmp_path / f"{number}.png"
        run_node(TAKES, bag=bag, params={"output": str(file), "delay": delay})
        np.testing.assert_array_equal(cv2.imread(str(file)), frames[number])


def test_picture_is_saved_in_the_working_folder(
    bag: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    recording = run_node(TAKES, bag=bag)
    assert [path.name for path in tmp_path.iterdir()] == ["waterhole_frame.png"]
    assert "waterhole_frame.png, 640 x 480" in recording.log[-1].text


def test_broken_picture_is_not_saved_but_the_next(tmp_path: Path, frames: list[np.ndarray]) -> None:
    file = tmp_path / "a.png"
    broken = bag_with_a_broken_frame(tmp_path / "a.bag", frames[2])
    run_node(TAKES, bag=broken, params={"output": str(file)})
    np.testing.assert_array_equal(cv2.imread(str(file)), frames[2])


@pytest.mark.parametrize(
    ("params", "words"),
    [
        ({"output": "no/such/folder.png"}, "cannot write .*Does its folder exist"),
        ({"output": "picture.xyz"}, "cannot write .*end in .png"),
        ({"image_topic": "/nothing", "timeout": 2}, "no picture on /nothing in 2 s"),
    ],
)
def test_failure_to_take_a_picture_is_told(
    bag: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, params: dict, words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(NodeError, match=words):
        run_node(TAKES, bag=bag, params=params)
    assert list(tmp_path.iterdir()) == []


# ----- both


def test_nodes_need_nothing_of_ours_and_may_be_executed() -> None:
    for node in (TAKES, FINDS):
        assert "course_lib" not in node.read_text(encoding="utf-8")
        assert node.stat().st_mode & 0o111


def test_launch_file_and_node_name_the_same_match_count() -> None:
    launch = (UNIT4 / "launch" / "exercise4_2_2.launch").read_text(encoding="utf-8")
    counts = re.findall(r"^MATCH_COUNT = (\d+)$", FINDS.read_text(encoding="utf-8"), re.MULTILINE)
    assert re.findall(r'"match_count" default="(\d+)"', launch) == counts
    assert len(counts) == 1
