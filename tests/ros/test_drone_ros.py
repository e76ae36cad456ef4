"""The simulated drone on real ROS: the unit's own `rostopic pub /cmd_vel` moves it."""

from __future__ import annotations

import sys
import time
import xmlrpc.client
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from course_lib.drone import why_not
from course_lib.offline_ros.bag import BagSource
from course_lib.real_ros import Program, Ros

pytestmark = pytest.mark.skipif(bool(why_not()), reason=why_not())

CORNERS, IMAGE = "/waterhole/corners", "/camera/rgb/image_raw"
KEPT = [CORNERS, "/drone/well", "/drone/pose", "/camera/rgb/camera_info"]


def wait_until(condition: Callable[[], object], seconds: float = 60) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.05)


@pytest.fixture
def drone(ros: Ros) -> Iterator[Program]:
    program = ros.start(sys.executable, "-m", "course_lib.drone_node", "--rate", "10")
    wait_until(lambda: ros.nodes_on(IMAGE)[0])
    yield program
    program.end()


def recorded(bag: Path) -> dict[str, list[tuple[int, Any]]]:
    source = BagSource(bag)
    messages: dict[str, list[tuple[int, Any]]] = {}
    for arrival in source:
        messages.setdefault(arrival.topic, []).append((arrival.stamp_ns, arrival.load()))
    source.close()
    return messages


def stamp(message: Any) -> int:
    return int(message.header.stamp.to_nsec())


def points(message: Any) -> np.ndarray:
    return np.array([(p.x, p.y) for p in message.polygon.points], np.float32).reshape(-1, 2)


def overlap(found: np.ndarray, silhouette: np.ndarray) -> float:
    """Intersection over union of the found outline and the box round the well."""
    x, y, w, h = cv2.boundingRect(silhouette)
    box = np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h]])
    masks = [
        cv2.fillPoly(np.zeros((480, 640), np.uint8), [np.rint(each).astype(np.int32)], 1) > 0
        for each in (found, box)
    ]
    return float((masks[0] & masks[1]).sum() / (masks[0] | masks[1]).sum())


@pytest.mark.usefixtures("drone")
def test_rostopic_pub_flies_it_to_the_well_and_a_node_finds_it(ros: Ros, tmp_path: Path) -> None:
    finder = ros.start("roslaunch", "unit4", "exercise4_2_2.launch")
    wait_until(lambda: ros.nodes_on(CORNERS)[0])
    recorder = ros.start("rosbag", "record", "--quiet", "-O", str(tmp_path / "flight.bag"), *KEPT)
    wait_until(lambda: all(ros.nodes_on(topic)[1] for topic in KEPT))
    time.sleep(1)
    pilot = ros.start(
        *("rostopic", "pub", "/cmd_vel", "geometry_msgs/Twist", "{linear: {x: 0.5}}", "-r", "5")
    )
    wait_until(lambda: ros.nodes_on("/cmd_vel")[0])
    time.sleep(5)
    pilot.end()
    time.sleep(2)
    recorder.end()
    finder.end()
    messages = recorded(tmp_path / "flight.bag")

    poses = messages["/drone/pose"]
    times = np.array([stamp(m) / 1e9 for _, m in poses])
    places = np.array([[getattr(m.pose.position, k) for k in "xyz"] for _, m in poses])
    way = np.linalg.norm(places - places[0], axis=1)
    assert way[-1] > 1  # it flew
    # Over the whole way: on a busy machine single pictures come late, and then two at once.
    steady = (way > 0.2 * way[-1]) & (way < 0.8 * way[-1])
    speed = np.polyfit(times[steady] - times[0], way[steady], 1)[0]
    assert np.ptp(way[times < times[0] + 0.5]) < 0.02  # nobody had commanded it
    assert speed == pytest.approx(0.5, abs=0.15)
    assert np.ptp(way[times > times[-1] - 0.5]) < 0.02  # and hovers once nobody commands it
    assert np.linalg.norm(places[-1][:2]) < np.linalg.norm(places[0][:2]) - 1  # to the well

    truth = {stamp(m): points(m) for _, m in messages["/drone/well"]}
    info = messages["/camera/rgb/camera_info"]
    assert {stamp(m) for _, m in info} <= set(truth) | {stamp(info[0][1]), stamp(info[-1][1])}
    assert info[0][1].K[0] == pytest.approx(512.107, abs=0.01)
    overlaps = [
        overlap(points(m), truth[stamp(m)])
        for _, m in messages[CORNERS]
        if stamp(m) in truth and len(points(m))
    ]
    assert len(overlaps) >= 10
    assert np.median(overlaps) > 0.6


@pytest.mark.usefixtures("drone")
def test_pictures_come_at_a_steady_rate(ros: Ros, tmp_path: Path) -> None:
    bag = tmp_path / "rate.bag"
    ros.run("rosbag", "record", "--quiet", "--duration=6", "-O", str(bag), "/camera/rgb/image_raw")
    pictures = [m for _, m in recorded(bag)["/camera/rgb/image_raw"]]
    gaps = np.diff([stamp(m) / 1e9 for m in pictures])
    assert 0.08 < np.median(gaps) < 0.6  # ten a second, or what a busy machine can
    assert pictures[0].encoding == "bgr8"
    assert (pictures[0].width, pictures[0].height, pictures[0].step) == (640, 480, 1920)


def test_without_a_master_it_says_so(ros: Ros) -> None:
    nowhere = "ROS_MASTER_URI=http://127.0.0.1:9"
    lost = ros.start("env", nowhere, sys.executable, "-m", "course_lib.drone_node")
    assert lost.wait(60) == 1
    assert "start roscore first" in lost.output


def test_drone_ends_with_its_ros_side(ros: Ros, drone: Program) -> None:
    # What `rosnode kill` does, which Debian keeps in a package of its own.
    master = xmlrpc.client.ServerProxy(ros.environment["ROS_MASTER_URI"])
    node = xmlrpc.client.ServerProxy(master.lookupNode("/test", "/drone")[2])
    node.shutdown("/test", "the test is over")
    assert drone.wait(30) == 0
