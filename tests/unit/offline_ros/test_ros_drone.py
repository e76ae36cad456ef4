"""A node without ROS flies the simulated drone: what it publishes on /cmd_vel moves the camera."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from course_lib.drone import Drone, why_not
from course_lib.offline_ros import BagError, run_node
from course_lib.offline_ros.flown import DroneSource
from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.wire import serialize

pytestmark = pytest.mark.skipif(bool(why_not()), reason=why_not())

NODES = Path(__file__).parent / "nodes"


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    with Drone(seed=4, position=(-1.1, -6.0, 1.6)) as drone:
        frame = drone.frame()
    assert frame.truth
    x, y, w, h = cv2.boundingRect(np.array(frame.truth["well"]["polygon"], np.int32))
    file = tmp_path_factory.mktemp("template") / "well.png"
    cv2.imwrite(str(file), frame.image[y : y + h, x : x + w])
    return file


def seek(template: Path, out: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "course_lib.offline_ros", str(NODES / "seeker.py")]
    options = ["--drone", "--heading=0", "--duration=8", f"--record={out}"]
    return subprocess.run(
        [*command, *options, f"_template:={template}"],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ,
    )


def story(out: Path) -> list[tuple[int, int, float]]:
    from course_lib.offline_ros.recording import Recording  # noqa: PLC0415

    lines = [message.data.split() for _, message in Recording(out)["/seeker/story"]]
    return [(int(stamp), int(seen), float(middle)) for stamp, seen, middle in lines]


def test_node_turns_until_it_sees_the_well(template: Path, tmp_path: Path) -> None:
    done = seek(template, tmp_path / "a.bag")
    assert done.returncode == 0, done.stderr
    assert "81 pictures" in done.stderr
    told = story(tmp_path / "a.bag")
    assert not any(seen for _, seen, _ in told[:3])  # it looked away at first
    assert np.mean([seen for _, seen, _ in told[-30:]]) > 0.8  # and stopped where the well is
    middles = [middle for _, seen, middle in told[-10:] if seen]
    assert np.ptp(middles) < 150


def test_same_node_flies_the_same_way_again(template: Path, tmp_path: Path) -> None:
    stories = []
    for name in ("b.bag", "c.bag"):
        run = run_node(
            NODES / "seeker.py", bag="drone", params={"template": str(template)}, duration=2
        )
        run.save(tmp_path / name)
        stories.append(story(tmp_path / name))
    assert len(stories[0]) == 21
    assert stories[0] == stories[1]


def twist(vx: float) -> bytes:
    message = message_class("geometry_msgs/Twist")()
    message.linear.x = vx
    return serialize(message)


def test_commands_count_from_their_own_moment() -> None:
    source = DroneSource(topics=["/camera/rgb/image_raw"], max_frames=12)
    arrivals = list(source)
    try:
        # Given at 0.25 s, heard before the picture of 0.2 s is taken: it must not change that one.
        start = source._drone.position
        source.hear("/cmd_vel", "geometry_msgs/Twist", source.start_ns + 250_000_000, twist(1.0))
        arrivals[2].load()
        assert np.array_equal(source._drone.position, start)
        arrivals[5].load()
        assert np.linalg.norm(source._drone.position - start) > 0.02
        arrivals[11].load()
        # Half a second after the only command it hovers.
        assert source._drone.velocity[0] < 0.6
        assert arrivals[11].load() is arrivals[11].load()
    finally:
        source.close()


def test_unknown_topic_is_named() -> None:
    with pytest.raises(BagError, match="no topic /camera/depth"):
        DroneSource(topics=["/camera/depth"])
