"""What goes wrong on ROS is said, and nothing stays behind."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest
from flight_piece import PACKAGE, Piece

from course_lib.offline_ros import NodeError
from course_lib.real_ros import Ros, RosError, run_launch
from course_lib.real_ros.processes import marked

NODES = {
    "dies": "import sys\nsys.exit('no template, no node')",
    "raises": """
        import rospy
        from sensor_msgs.msg import Image
        from std_msgs.msg import Int32

        def on_image(message):
            counts.publish(message.header.seq)
            if message.header.seq == 2:
                raise ValueError("two is too many")

        rospy.init_node("raises")
        counts = rospy.Publisher("count", Int32, queue_size=10)
        rospy.Subscriber("/camera/rgb/image_raw", Image, on_image)
        rospy.spin()
    """,
    "deaf": """
        import signal, subprocess, time
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)
        subprocess.Popen(["sleep", "1000"])
        print("deaf", flush=True)
        time.sleep(1000)
    """,
    "sleeper": """
        import rospy
        from sensor_msgs.msg import Image
        from std_msgs.msg import Float64

        rospy.init_node("sleeper")
        times = rospy.Publisher("time", Float64, queue_size=10)
        rospy.sleep(0.25)
        newest = []
        rospy.Subscriber("/camera/rgb/image_raw", Image, newest.append)
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            if newest:
                times.publish(rospy.get_time() - newest[-1].header.stamp.to_sec())
            rate.sleep()
    """,
}


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A package of nodes that misbehave."""
    folder = tmp_path_factory.mktemp("packages") / "bad"
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text(
        '<package format="2"><name>bad</name><version>1.0.0</version><description>Bad</description>'
        '<maintainer email="a@example.org">A</maintainer><license>MIT</license></package>'
    )
    for name, code in NODES.items():
        node = folder / f"{name}.py"
        node.write_text(f"#!/usr/bin/env python3\n{textwrap.dedent(code)}\n")
        node.chmod(0o755)
        line = f'<node pkg="bad" type="{name}.py" name="{name}" output="screen"/>'
        (folder / "launch" / f"{name}.launch").write_text(f"<launch>{line}</launch>")
    (folder / "launch" / "torn.launch").write_text('<launch>\n  <node pkg="bad"\n</launch>\n')
    (folder / "launch" / "nobody.launch").write_text(
        '<launch><node pkg="bad" type="nobody.py" name="nobody"/></launch>'
    )
    return folder


@pytest.fixture(scope="module")
def ros(package: Path) -> Ros:
    with Ros(package.parent) as master:
        yield master


def test_torn_launch_file_is_named(ros: Ros) -> None:
    launch = ros.start("roslaunch", "bad", "torn.launch")
    assert launch.wait(60) == 1
    assert "Invalid roslaunch XML syntax: not well-formed" in launch.output
    assert "line 3" in launch.output


def test_missing_node_is_named(ros: Ros) -> None:
    launch = ros.start("roslaunch", "bad", "nobody.launch")
    launch.wait(60)
    assert "Cannot locate node of type [nobody.py] in package [bad]" in launch.output


def test_unknown_package_is_named(ros: Ros) -> None:
    with pytest.raises(RosError, match=r"status 1:(?s:.*)\[absent\]"):
        ros.run("roslaunch", "absent", "any.launch")


def test_node_that_dies_is_reported(ros: Ros) -> None:
    launch = ros.start("roslaunch", "bad", "dies.launch")
    assert launch.wait(60) == 0  # so says roslaunch: not every node is needed
    assert "no template, no node" in launch.output
    assert "process has died" in launch.output
    assert "exit code 1" in launch.output


def test_finder_without_its_template_takes_its_launch_file_down(tmp_path: Path) -> None:
    shutil.copytree(PACKAGE, tmp_path / "unit4")
    (tmp_path / "unit4" / "waterhole.png").unlink()
    with Ros(tmp_path) as ros:
        launch = ros.start("roslaunch", "unit4", "example4_5.launch")
        launch.wait(60)
        assert "REQUIRED process [example4_5-1] has died!" in launch.output
        assert "FileNotFoundError: no file" in launch.output


def test_run_says_which_node_died(package: Path, piece: Piece) -> None:
    with pytest.raises(NodeError, match="dies has died, exit code 1") as caught:
        run_launch(package, "dies.launch", bag=piece.bag)
    assert "no template, no node" in caught.value.traceback


def test_run_says_why_a_launch_file_does_not_start(package: Path, piece: Piece) -> None:
    with pytest.raises(NodeError, match=r"torn\.launch does not start") as caught:
        run_launch(package, "torn.launch", bag=piece.bag)
    assert "not well-formed" in caught.value.traceback


def test_exception_in_a_callback_ends_the_run_and_is_shown(package: Path, piece: Piece) -> None:
    with pytest.raises(NodeError, match="raised an exception") as caught:
        run_launch(package, "raises.launch", bag=piece.bag)
    assert "ValueError: two is too many" in caught.value.traceback
    counts = [message.data for _, message in caught.value.recording["/count"]]
    assert len(counts) == len(set(counts))
    assert counts[-1] == 2


def test_node_that_goes_by_the_clock_is_given_time(package: Path, piece: Piece) -> None:
    recording = run_launch(package, "sleeper.launch", bag=piece.bag)
    ages = [message.data for _, message in recording["/time"]]
    assert len(ages) >= 10
    assert all(0 <= age <= 0.2 for age in ages[:8])


def test_deaf_node_and_its_children_are_ended(package: Path) -> None:
    with Ros(package.parent) as ros:
        launch = ros.start(
            "roslaunch", "--sigint-timeout=0.5", "--sigterm-timeout=0.5", "bad", "deaf.launch"
        )
        launch.wait_for("^deaf$|\ndeaf\n")
        core, *_ = ros._programs
        marks = [program.mark for program in ros._programs]
        assert len(launch.pids()) >= 3  # roslaunch, the node, its child
        port = int(ros.environment["ROS_MASTER_URI"].rpartition(":")[2])
        folder = Path(core._printed).parent
        assert folder.is_dir()
    assert [marked(mark) for mark in marks] == [[], []]
    with socket.socket() as probe:
        assert probe.connect_ex(("127.0.0.1", port)) != 0
    assert not folder.exists()


def test_master_goes_with_a_caller_that_is_killed() -> None:
    code = """
        import os, signal
        from course_lib.real_ros import Ros
        with Ros() as ros:
            print(ros._programs[0].mark, flush=True)
            os.kill(os.getpid(), signal.SIGKILL)
    """
    caller = [sys.executable, "-c", textwrap.dedent(code)]
    ran = subprocess.run(caller, stdout=subprocess.PIPE, text=True, check=False)
    assert ran.returncode == -signal.SIGKILL
    deadline = time.monotonic() + 60
    while (left := marked(ran.stdout.strip())) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert left == []


def test_masters_do_not_see_each_other(ros: Ros) -> None:
    with Ros() as other:
        other.set_param("/mine", 1)
        assert other.environment["ROS_MASTER_URI"] != ros.environment["ROS_MASTER_URI"]
        with pytest.raises(RosError, match="not set"):
            ros.run("rosparam", "get", "/mine")
    assert not any(name in os.environ for name in ("ROS_MASTER_URI", "ROS_HOME"))


def test_a_node_for_python_finds_debians(ros: Ros) -> None:
    assert "3.11" in ros.run("env", "python", "-c", "import rospy, sys; print(sys.version)")
