"""Whole nodes, each a real process fed from a small bag."""

from __future__ import annotations

import re
import time
from typing import TYPE_CHECKING

import cv2
import numpy as np
import pytest
from synthetic_bag import FRAME_NS, NODES, START_NS, frame, write_bag

from course_lib.offline_ros import BagError, NodeError, run_node
from course_lib.offline_ros.modules.cv_bridge import CvBridge

if TYPE_CHECKING:
    from pathlib import Path


def test_every_picture_arrives_in_order_and_unchanged(bag: Path) -> None:
    recording = run_node(NODES / "subscriber.py", bag=bag)
    assert list(recording) == ["/subscriber_1/mean", "/turned"]
    stamps = [stamp for stamp, _ in recording["/turned"]]
    assert stamps == [START_NS + i * FRAME_NS for i in range(20)]
    assert [m.data for _, m in recording["/subscriber_1/mean"]] == [i * 10.0 for i in range(20)]
    for index, (stamp, message) in enumerate(recording["/turned"]):
        assert message.header.stamp.to_nsec() == stamp
        assert (message.encoding, message.width, message.step) == ("bgr8", 64, 192)
        picture = CvBridge().imgmsg_to_cv2(message)
        np.testing.assert_array_equal(picture, cv2.rotate(frame(index), cv2.ROTATE_180))


def test_two_runs_are_equal_byte_for_byte(bag: Path) -> None:
    first, second = (run_node(NODES / "subscriber.py", bag=bag) for _ in range(2))
    assert first.output == second.output
    assert first["/turned"] == second["/turned"]


def test_log_lines_look_as_on_ros_and_are_recorded(bag: Path) -> None:
    recording = run_node(NODES / "subscriber.py", bag=bag, max_frames=2)
    assert recording.output.splitlines()[0] == ("[INFO] [1600000000.000000]: frame 0 of camera")
    assert [(line.level, line.text) for line in recording.log] == [
        ("INFO", "frame 0 of camera")
    ] * 2


def test_remapped_topics(bag: Path) -> None:
    recording = run_node(
        NODES / "subscriber.py",
        bag=bag,
        remap={"turned": "/upside_down", "/camera/rgb/image_raw": "/nothing", "__name": "me"},
    )
    assert {topic: len(recording[topic]) for topic in recording} == {
        "/me/mean": 0,
        "/upside_down": 0,
    }


def test_publisher_loop_keeps_its_rate_and_ends_with_the_bag(bag: Path) -> None:
    recording = run_node(NODES / "talker.py", bag=bag)
    stamps = np.array([stamp for stamp, _ in recording["/chatter"]])
    assert stamps[0] == START_NS
    np.testing.assert_array_equal(np.diff(stamps), 200_000_000)
    assert len(stamps) == 15  # 1.9 s of recording and one second more
    assert recording["/chatter"][3][1].data == "hello 1600000000.6"


def test_duration_ends_the_run(bag: Path) -> None:
    recording = run_node(NODES / "talker.py", bag=bag, duration=0.5)
    assert len(recording["/chatter"]) == 3


def test_class_with_timer_compressed_pictures_and_hook(bag: Path) -> None:
    recording = run_node(NODES / "timer_class.py", bag=bag)
    reports = [(m.point.x, m.point.y, m.point.z) for _, m in recording["/report"]]
    # The first picture passes while the node waits for the camera's calibration.
    assert reports == [(n, 64, 50.0) for n in (5, 10, 15, 19, 19)]
    assert recording.output == "bye 19 True\n"


def test_parameters_and_names(bag: Path) -> None:
    recording = run_node(
        NODES / "params.py",
        bag=bag,
        params={"match_count": 7, "~gain": True, "text": "12", "list": [1, "a"]},
        remap={"__name": "other"},
    )
    assert recording.output.splitlines() == [
        "count 7",
        "gain True",
        "text '12'",
        "list [1, 'a']",
        "has True True",
        "nested 2 {'a': 1, 'b': {'c': 2}}",
        "search /other/match_count",
        "name /other /x /other/x",
        "argv []",
        "missing '/other/missing'",
        "heard late",
        "[DEBUG] [1600000000.100000]: a detail",
    ]


def test_parameters_that_are_not_the_nodes_own(bag: Path, tmp_path: Path) -> None:
    node = tmp_path / "reads.py"
    node.write_text(
        "import rospy\nrospy.init_node('reads')\n"
        "print(rospy.get_param('/n'), rospy.get_param('text'), rospy.get_param('/well'))\n"
    )
    shared = {"/n": 58, "/ns/text": "5", "/well/a": [1], "/well/b": {"c": True}}
    recording = run_node(node, bag=bag, remap={"__ns": "ns"}, params=shared)
    assert recording.output == "58 5 {'a': [1], 'b': {'c': True}}\n"


def test_crash_shows_the_nodes_own_lines_and_keeps_what_was_published(bag: Path) -> None:
    with pytest.raises(NodeError, match=r"crash\.py crashed") as caught:
        run_node(NODES / "crash.py", bag=bag)
    text = caught.value.traceback
    assert text.endswith("ValueError: third picture is too much")
    assert re.findall(r"line \d+, in (\w+|<module>)", text) == ["<module>", "on_image", "work"]
    assert re.findall(r"File \"(.*?)\"", text) == ["crash.py"] * 3
    assert caught.value.recording is not None
    assert [m.data for _, m in caught.value.recording["/count"]] == [1, 2]


def test_keep_going_logs_a_crash_as_ros_does(bag: Path) -> None:
    recording = run_node(NODES / "crash.py", bag=bag, keep_going=True)
    assert [m.data for _, m in recording["/count"]] == [1, 2, *range(4, 21)]
    assert [line.level for line in recording.log] == ["ERROR"]
    assert "third picture is too much" in recording.log[0].text


@pytest.mark.parametrize("kind", ["polling", "time.sleep", "thread", "join"])
def test_loops_that_never_return_get_every_picture_and_are_ended(bag: Path, kind: str) -> None:
    recording = run_node(NODES / "loops.py", bag=bag, params={"kind": kind}, timeout=30)
    assert [m.data for _, m in recording["/count"]] == list(range(1, 21))
    assert recording.outcome["reason"] == "the recording has ended"
    assert ("was stopped" in recording.output) == (kind == "time.sleep")


def test_thread_with_its_own_rate_runs_in_step_with_the_pictures(bag: Path) -> None:
    runs = [run_node(NODES / "loops.py", bag=bag, params={"kind": "thread"}) for _ in range(2)]
    ticks, again = ([m.data for _, m in run["/ticks"]] for run in runs)
    assert ticks[-1] == 20
    assert ticks[2:] == again[2:]


def test_a_node_without_sign_of_life_is_stopped_and_told_where_it_was(bag: Path) -> None:
    start = time.monotonic()
    with pytest.raises(NodeError, match=r"waited for nothing in 3 s") as caught:
        run_node(NODES / "loops.py", bag=bag, params={"kind": "deaf"}, stall=3)
    assert time.monotonic() - start < 30
    assert "loops.py" in caught.value.traceback
    assert caught.value.recording is not None


def test_timeout(bag: Path) -> None:
    with pytest.raises(NodeError, match=r"still ran after 1 s"):
        run_node(NODES / "loops.py", bag=bag, params={"kind": "deaf"}, timeout=1)


def test_modules_within_rospy_and_others(bag: Path, tmp_path: Path) -> None:
    package = tmp_path / "mine"
    (package / "src").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>mine</name></package>")
    node = package / "src" / "node.py"
    node.write_text(
        "import message_filters, roslib.packages, rospy, rospy.timer\n"
        "from rospy.numpy_msg import numpy_msg\n"
        "from rospy.rostime import Duration, wallsleep\n"
        "from sensor_msgs.msg import Image\n"
        "rospy.init_node('n')\n"
        "print(roslib.packages.get_pkg_dir('mine'))\n"
        "m = rospy.wait_for_message('/camera/rgb/image_raw', numpy_msg(Image))\n"
        "print(type(m.data).__name__, m.data[0])\n"
        "from std_msgs.msg import Float32MultiArray\n"
        "numbers = rospy.Publisher('numbers', Float32MultiArray, queue_size=1, latch=True)\n"
        "numbers.publish(data=[1.5, 2])\n"
        "got = rospy.wait_for_message('numbers', numpy_msg(Float32MultiArray), timeout=1)\n"
        "print(got.data.dtype, got.data)\n"
        "source = message_filters.Subscriber('/camera/rgb/image_raw', Image)\n"
        "kept, seen = message_filters.Cache(source, 3), []\n"
        "kept.registerCallback(seen.append)\n"
        "wallsleep(1.05)\n"
        "last = kept.getLatestTime()\n"
        "print(len(seen), len(kept.getInterval(kept.getOldestTime(), last)))\n"
        "print(kept.getElemBeforeTime(last) is kept.getLast() is seen[-1])\n"
        "print(kept.getElemAfterTime(last - Duration(0.1)) is seen[-2])\n"
        "print(kept.getElemAfterTime(last + Duration(1)))\n"
    )
    recording = run_node(node, bag=bag)
    assert recording.output.splitlines() == [
        str(package),
        f"bytes {frame(0)[0, 0, 0]}",
        "float32 [1.5 2. ]",
        "10 3",
        "True",
        "True",
        "None",
    ]


@pytest.mark.parametrize("build", ["catkin_python_setup()", "# catkin_python_setup()"])
def test_the_packages_own_modules(bag: Path, tmp_path: Path, build: str) -> None:
    for folder in ("nodes", "src/mine"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "package.xml").write_text("<package><name>mine</name></package>")
    (tmp_path / "CMakeLists.txt").write_text(f"project(mine)\n{build}\ncatkin_package()\n")
    (tmp_path / "setup.py").write_text("raise SystemExit('catkin runs this')")
    (tmp_path / "src" / "mine" / "__init__.py").write_text("WORD = 'found'\n")
    node = tmp_path / "nodes" / "node.py"
    node.write_text("import rospy\nfrom mine import WORD\nprint(WORD)\n")
    if build.startswith("#"):
        with pytest.raises(NodeError, match="No module named 'mine'"):
            run_node(node, bag=bag)
    else:
        assert run_node(node, bag=bag).output == "found\n"


def test_windows_become_pictures(bag: Path) -> None:
    recording = run_node(NODES / "window.py", bag=bag)
    assert list(recording.windows) == ["camera"]
    np.testing.assert_array_equal(recording.windows["camera"], frame(19))


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("rospy.ServiceProxy('a', None)", "rospy.ServiceProxy is not supported by offline_ros"),
        ("rospy.wait_for_service('a')", "rospy.wait_for_service is not supported by offline_ros"),
        ("import tf", "import tf is not supported by offline_ros"),
        ("from std_srvs.srv import Empty", "std_srvs"),
        ("from sensor_msgs.srv import SetCameraInfo", "import sensor_msgs.srv is not supported"),
        ("cv2.selectROI('w', None)", "cv2.selectROI is not supported by offline_ros"),
        ("from rospy.impl import tcpros", "import rospy.impl is not supported by offline_ros"),
        ("import roslib.message", "import roslib.message is not supported by offline_ros"),
        ("rospy.nonsense()", "module 'rospy' has no attribute 'nonsense'"),
        ("from sensor_msgs.msg import Picture", "Picture"),
    ],
)
def test_unsupported_calls_are_refused_by_name(
    bag: Path, tmp_path: Path, line: str, said: str
) -> None:
    node = tmp_path / "node.py"
    node.write_text(f"import cv2\nimport rospy\nrospy.init_node('n')\n{line}\n")
    with pytest.raises(NodeError) as caught:
        run_node(node, bag=bag)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("rospy.spin()", "ROSInitException: client code must call rospy.init_node() first"),
        ("rospy.sleep(1)", "time is not initialized. Have you called init_node()?"),
        ("rospy.Time.now()", "time is not initialized. Have you called init_node()?"),
        ("rospy.init_node('a/b')", "ValueError: namespaces are not allowed in node names"),
        ("rospy.Publisher('x', Int8, queue_size=1).publish(1)", "has not been initialized"),
        ("rospy.Subscriber('x', int, print)", "is not a message data class"),
        ("rospy.Subscriber('no way', Int8, print)", "'no way' is not a legal ROS name"),
        ("rospy.init_node('a'); rospy.init_node('b')", "has already been called as /a, now as /b"),
        (
            "rospy.init_node('a'); rospy.Publisher('x', Int8, queue_size=1).publish(1000)",
            "std_msgs/Int8.data = 1000 does not fit in int8",
        ),
        (
            "rospy.init_node('a'); rospy.wait_for_message('/x', Int8, timeout=0.5)",
            "ROSException: timeout exceeded while waiting for message on topic /x",
        ),
        ("import sys; sys.exit('no camera')", "no camera"),
        ("if True print()", "SyntaxError"),
    ],
)
def test_mistakes_are_told_as_ros_tells_them(
    bag: Path, tmp_path: Path, line: str, said: str
) -> None:
    node = tmp_path / "node.py"
    node.write_text(f"import rospy\nfrom std_msgs.msg import Int8\n{line}\n")
    with pytest.raises(NodeError) as caught:
        run_node(node, bag=bag)
    assert said in str(caught.value)


def test_a_node_killed_from_inside_is_an_error(bag: Path, tmp_path: Path) -> None:
    node = tmp_path / "node.py"
    node.write_text("import os\nos.kill(os.getpid(), 9)\n")
    with pytest.raises(NodeError, match="by signal 9"):
        run_node(node, bag=bag)


def test_queue_of_one_drops_old_pictures_while_the_callback_waits(
    bag: Path, tmp_path: Path
) -> None:
    node = tmp_path / "slow.py"
    node.write_text(
        "import rospy\nfrom sensor_msgs.msg import Image\nfrom std_msgs.msg import Time\n"
        "def slow(m):\n    pub.publish(m.header.stamp)\n    rospy.sleep(0.45)\n"
        "rospy.init_node('slow')\npub = rospy.Publisher('/t', Time, queue_size=1)\n"
        "rospy.Subscriber('/camera/rgb/image_raw', Image, slow, queue_size=1)\n"
        "try:\n    rospy.spin()\nexcept rospy.ROSInterruptException:\n    pass\n"
    )
    recording = run_node(node, bag=bag)
    seen = [(m.data.to_nsec() - START_NS) // FRAME_NS for _, m in recording["/t"]]
    assert seen == [0, 4, 9, 13, 18, 19]
    assert recording.outcome["dropped"] == 14


def test_wall_clock_rate_takes_its_time_and_a_slow_node_misses_pictures(
    bag: Path, tmp_path: Path
) -> None:
    node = tmp_path / "slow.py"
    node.write_text(
        "import rospy, threading\nfrom sensor_msgs.msg import Image\n"
        "from std_msgs.msg import Empty\n"
        "def slow(m):\n    threading.Event().wait(0.2)\n    pub.publish()\n"
        "rospy.init_node('slow')\npub = rospy.Publisher('/t', Empty, queue_size=1)\n"
        "rospy.Subscriber('/camera/rgb/image_raw', Image, slow, queue_size=1)\nrospy.spin()\n"
    )
    recording = run_node(node, bag=bag, rate=20)
    assert 1.0 < recording.outcome["seconds"] < 6.0
    assert 2 <= len(recording["/t"]) <= 9
    assert len(recording["/t"]) + recording.outcome["dropped"] == 20


def test_bad_bags_are_told(tmp_path: Path, bag: Path) -> None:
    with pytest.raises(BagError, match=r"no bag 'nowhere\.bag'"):
        run_node(NODES / "talker.py", bag="nowhere.bag")
    broken = tmp_path / "broken.bag"
    broken.write_bytes(b"#ROSBAG V2.0\n" + bytes(50))
    with pytest.raises(BagError, match=r"broken\.bag cannot be read as a ROS bag"):
        run_node(NODES / "talker.py", bag=broken)
    with pytest.raises(BagError, match=r"no topic /x; it has .*/camera/rgb/image_raw"):
        run_node(NODES / "talker.py", bag=bag, topics=["/x"])
    with pytest.raises(FileNotFoundError, match="no node file"):
        run_node(tmp_path / "none.py", bag=bag)


def test_rgb_camera_publishes_rgb(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "rgb.bag", [frame(3)] * 2, fmt="rgb8; jpeg compressed bgr8")
    node = tmp_path / "echo.py"
    node.write_text(
        "import rospy\nfrom sensor_msgs.msg import Image\n"
        "rospy.init_node('e')\np = rospy.Publisher('/echo', Image, queue_size=1)\n"
        "rospy.Subscriber('/camera/rgb/image_raw', Image, p.publish)\nrospy.spin()\n"
    )
    message = run_node(node, bag=path)["/echo"][0][1]
    assert message.encoding == "rgb8"
    np.testing.assert_array_equal(CvBridge().imgmsg_to_cv2(message, "bgr8"), frame(3))


def test_a_picture_is_taken_by_a_node_that_ends_by_itself(bag: Path, tmp_path: Path) -> None:
    node = tmp_path / "take_photo.py"
    node.write_text(
        "import cv2, rospy\nfrom cv_bridge import CvBridge\nfrom sensor_msgs.msg import Image\n"
        "class TakePhoto:\n"
        "    def __init__(self):\n"
        "        self.picture = None\n"
        "        rospy.Subscriber('/camera/rgb/image_raw', Image, self.keep)\n"
        "        rospy.sleep(0.75)\n"
        "    def keep(self, message):\n"
        "        self.picture = CvBridge().imgmsg_to_cv2(message, 'bgr8')\n"
        "        self.topic = message._connection_header['topic']\n"
        "rospy.init_node('take_photo')\n"
        "photo = TakePhoto()\n"
        "cv2.imwrite(rospy.get_param('~file'), photo.picture)\n"
        "print(photo.topic)\n"
    )
    recording = run_node(node, bag=bag, params={"file": str(tmp_path / "photo.png")})
    assert recording.output == "/camera/rgb/image_raw\n"
    assert recording.outcome["reason"] == "the node has returned"
    np.testing.assert_array_equal(cv2.imread(str(tmp_path / "photo.png")), frame(7))


def test_parameters_of_the_robot_and_of_the_node(bag: Path, tmp_path: Path) -> None:
    node = tmp_path / "asker.py"
    node.write_text(
        "import rospy\nshared = rospy.get_param('/count')\nrospy.init_node('asker')\n"
        "print(shared, rospy.get_param('well/side'), rospy.get_param('~deep/a'))\n"
        "print(rospy.get_param('/well'), rospy.get_param('~deep'), rospy.has_param('count'))\n"
    )
    params = {"/count": 58, "/well": {"side": "left", "n": 2}, "deep": {"a": 1, "b": [1, 2]}}
    printed = run_node(node, bag=bag, params=params).output.splitlines()
    assert printed == [
        "58 left 1",
        "{'side': 'left', 'n': 2} {'a': 1, 'b': [1, 2]} True",
    ]


def test_a_node_that_floods_the_disk_is_stopped(bag: Path, tmp_path: Path) -> None:
    node = tmp_path / "flood.py"
    node.write_text("text = 'x' * 1_000_000\nwhile True:\n    print(text)\n")
    with pytest.raises(NodeError, match="the node printed more than 100 MB") as caught:
        run_node(node, bag=bag)
    assert caught.value.recording is not None
    assert len(caught.value.recording.output) <= 1_000_000


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"max_frames": 0}, "max_frames must be positive, not 0"),
        ({"timeout": -1.0}, "timeout must be positive"),
        ({"rate": float("nan")}, "rate must be positive"),
    ],
)
def test_wrong_options(bag: Path, options: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        run_node(NODES / "talker.py", bag=bag, **options)  # type: ignore[arg-type]
