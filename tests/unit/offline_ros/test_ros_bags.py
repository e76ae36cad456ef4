"""What may feed a node, and what is kept of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from rosbags.convert import convert
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore
from synthetic_bag import FRAME_NS, START_NS, frame

from course_lib.offline_ros import BagError, NodeError, Recording, run_node
from course_lib.offline_ros.messages import STORE, message_class
from course_lib.offline_ros.modules.cv_bridge import CvBridge
from course_lib.offline_ros.wire import serialize

if TYPE_CHECKING:
    from pathlib import Path

ECHO = """\
import rospy
from sensor_msgs.msg import CameraInfo, Image
rospy.init_node("echo")
image = rospy.Publisher("/echo/image", Image, queue_size=1)
info = rospy.Publisher("/echo/info", CameraInfo, queue_size=1)
rospy.Subscriber("/camera/rgb/image_raw", Image, image.publish)
rospy.Subscriber("/camera/rgb/camera_info", CameraInfo, info.publish)
rospy.spin()
"""


@pytest.fixture
def echo(tmp_path: Path) -> Path:
    node = tmp_path / "echo.py"
    node.write_text(ECHO)
    return node


def check_echo(recording: Recording) -> None:
    images, infos = recording["/echo/image"], recording["/echo/info"]
    assert [stamp for stamp, _ in images] == [START_NS + i * FRAME_NS for i in range(20)]
    assert all(message.K[:3] == (50.0, 0.0, 32.0) for _, message in infos)
    assert len(infos) == 20
    for index, (_, message) in enumerate(images):
        np.testing.assert_array_equal(CvBridge().imgmsg_to_cv2(message, "bgr8"), frame(index))


def test_ros1(bag: Path, echo: Path) -> None:
    check_echo(run_node(echo, bag=bag))


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_ros2(bag: Path, echo: Path, tmp_path: Path, storage: str) -> None:
    place = tmp_path / "ros2"
    convert(
        [bag],
        place,
        dst_storage=storage,
        dst_version=9,
        compress=None,
        compress_mode="file",
        default_typestore=None,
        typestore=get_typestore(Stores.ROS2_HUMBLE),
        exclude_topics=[],
        include_topics=[],
        exclude_msgtypes=[],
        include_msgtypes=[],
    )
    check_echo(run_node(echo, bag=place))


def test_raw_pictures_are_played_as_they_are(echo: Path, tmp_path: Path) -> None:
    path = tmp_path / "raw.bag"
    with Writer(path) as writer:
        connection = writer.add_connection(
            "/camera/rgb/image_raw", "sensor_msgs/msg/Image", typestore=STORE
        )
        for index in range(3):
            message = CvBridge().cv2_to_imgmsg(frame(index)[..., 0].copy(), "mono8")
            writer.write(connection, START_NS + index * FRAME_NS, serialize(message))
    recording = run_node(echo, bag=path)
    assert [m.encoding for _, m in recording["/echo/image"]] == ["mono8"] * 3
    assert recording["/echo/info"] == []
    assert (
        "nothing came on /camera/rgb/camera_info; the recording plays /camera/rgb/image_raw"
        in recording.output
    )


def test_a_damaged_picture_is_blamed_on_the_bag(echo: Path, tmp_path: Path) -> None:
    path = tmp_path / "damaged.bag"
    with Writer(path) as writer:
        connection = writer.add_connection(
            "/camera/rgb/image_raw/compressed", "sensor_msgs/msg/CompressedImage", typestore=STORE
        )
        for index in range(2):
            message = message_class("sensor_msgs/CompressedImage")(format="jpeg", data=b"noise")
            writer.write(connection, START_NS + index * FRAME_NS, serialize(message))
    with pytest.raises(NodeError, match=r"the compressed picture at .* is damaged"):
        run_node(echo, bag=path)


def test_only_some_topics_are_played_or_kept(bag: Path, echo: Path) -> None:
    recording = run_node(echo, bag=bag, topics=["/camera/rgb/camera_info"])
    assert (len(recording["/echo/image"]), len(recording["/echo/info"])) == (0, 20)
    recording = run_node(echo, bag=bag, keep=["/echo/info"])
    assert list(recording) == ["/echo/info"]
    assert len(recording["/echo/info"]) == 20


def test_a_topic_of_another_type_is_told(bag: Path, tmp_path: Path) -> None:
    node = tmp_path / "node.py"
    node.write_text(
        "import rospy\nfrom sensor_msgs.msg import CompressedImage\nrospy.init_node('n')\n"
        "rospy.Subscriber('/camera/rgb/image_raw', CompressedImage, print)\nrospy.spin()\n"
    )
    recording = run_node(node, bag=bag)
    assert recording.log[0].text == (
        "/camera/rgb/image_raw carries sensor_msgs/Image, but the node subscribes to it as "
        "sensor_msgs/CompressedImage: it will receive nothing"
    )


def test_streaming_gives_the_same_as_the_list(bag: Path, echo: Path) -> None:
    recording = run_node(echo, bag=bag, max_frames=5)
    assert list(recording.stream("/echo/image")) == recording["/echo/image"]
    assert "/echo/image: 5 messages" in repr(recording)


def test_progress_is_told(bag: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    node = tmp_path / "slow.py"
    node.write_text(
        "import rospy, threading\nfrom sensor_msgs.msg import Image\nrospy.init_node('n')\n"
        "rospy.Subscriber('/camera/rgb/image_raw', Image, lambda m: threading.Event().wait(0.1))\n"
        "rospy.spin()\n"
    )
    run_node(node, bag=bag, progress=True)
    assert capsys.readouterr().err.endswith(" pictures")


def test_not_a_recording(tmp_path: Path) -> None:
    path = tmp_path / "x.bag"
    path.write_text("no bag")
    with pytest.raises(BagError, match="is not a recording"):
        Recording(path)


def test_topics_are_brought_together_by_their_stamps(bag: Path, tmp_path: Path) -> None:
    node = tmp_path / "sync.py"
    node.write_text(
        "import message_filters, rospy\nfrom sensor_msgs.msg import CameraInfo, Image\n"
        "rospy.init_node('n')\n"
        "image = message_filters.Subscriber('/camera/rgb/image_raw', Image)\n"
        "info = message_filters.Subscriber('/camera/rgb/camera_info', CameraInfo)\n"
        "sync = message_filters.ApproximateTimeSynchronizer([image, info], 10, 0.02)\n"
        "sync.registerCallback(lambda a, b: print(a.header.stamp == b.header.stamp))\n"
        "rospy.spin()\n"
    )
    assert run_node(node, bag=bag).output.split() == ["True"] * 20


def test_package_folder_is_found(bag: Path, tmp_path: Path) -> None:
    (tmp_path / "unit4" / "src").mkdir(parents=True)
    (tmp_path / "unit4" / "package.xml").write_text("<package><name>unit4</name></package>")
    node = tmp_path / "unit4" / "src" / "node.py"
    node.write_text(
        "import rospkg, rospy, roslib\nroslib.load_manifest('unit4')\n"
        "print(rospkg.RosPack().get_path('unit4'))\nrospkg.RosPack().get_path('other')\n"
    )
    with pytest.raises(NodeError, match=r"other: no package\.xml of that name") as caught:
        run_node(node, bag=bag)
    assert caught.value.recording is not None
    assert caught.value.recording.output.startswith(str(tmp_path / "unit4"))
