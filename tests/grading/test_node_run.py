"""What a student's node saved is found wherever the exercise lets it save."""

from __future__ import annotations

import os
import time

import cv2
import numpy as np
import pytest

from course_lib.grading import agent, node_run

TMP = "/tmp/well.png"  # noqa: S108
TOPIC = "/camera/rgb/image_raw"
NODE = f"""#!/usr/bin/env python3
import os
import cv2
import rospy
from cv_bridge import CvBridge
from sensor_msgs.msg import Image

rospy.init_node("takes")
picture = CvBridge().imgmsg_to_cv2(rospy.wait_for_message("{TOPIC}", Image), "bgr8")
output = os.path.expanduser(rospy.get_param("~output"))
os.makedirs(os.path.dirname(output) or ".", exist_ok=True)
cv2.imwrite(output, picture)
"""


@pytest.mark.parametrize(
    "output",
    [
        "~/well.png",
        "~/Pictures/drone/well.png",
        "well.png",
        "$(env HOME)/well.png",
        "$(find unit4)/well.png",
        TMP,
    ],
)
def test_a_picture_is_found_where_it_was_saved(tmp_path, monkeypatch, output):
    home, work, tmp = (tmp_path / name for name in ("home", "home/work", "tmp"))
    (work / "unit4").mkdir(parents=True)
    tmp.mkdir()
    monkeypatch.chdir(work)
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setattr(node_run, "gettempdir", lambda: str(tmp))
    (home / "old.png").write_bytes(b"what was not saved by the node")
    (home / "linked.png").symlink_to(home / "old.png")
    (work / "unit4" / "takes.py").write_text(NODE)
    frame = cv2.imencode(".jpg", np.full((48, 64, 3), (200, 90, 20), np.uint8))[1].tobytes()
    os.utime(home / "old.png", (hour_ago := time.time() - 3600, hour_ago))
    ran = node_run.run(
        "unit4/takes.py", [10**18], [frame], TOPIC, {"output": output}, {}, [], timeout=60
    )
    assert ran["error"] is None
    assert len(ran["files"]) == 1, ran["files"].keys()
    saved = cv2.imdecode(np.frombuffer(next(iter(ran["files"].values())), np.uint8), 1)
    assert saved.shape == (48, 64, 3)


def test_what_a_node_said_before_it_published_anything_is_kept(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "says.py").write_text("import sys\nprint('no template')\nsys.exit(2)\n")
    frame = cv2.imencode(".jpg", np.zeros((48, 64, 3), np.uint8))[1].tobytes()
    ran = node_run.run("says.py", [10**18], [frame], TOPIC, {}, {}, [], timeout=60)
    assert "sys.exit(2)" in ran["error"]
    assert "no template" in ran["log"]


ODD_PICTURES = f"""#!/usr/bin/env python3
import rospy
from geometry_msgs.msg import Point32, PolygonStamped
from sensor_msgs.msg import CompressedImage, Image

rospy.init_node("odd")
corners = rospy.Publisher("/corners", PolygonStamped, queue_size=9)
pictures = rospy.Publisher("/image", Image, queue_size=9)
packed = rospy.Publisher("/packed", CompressedImage, queue_size=9)
rospy.wait_for_message("{TOPIC}", Image)
found = PolygonStamped()
found.polygon.points = [Point32(1, 2, 0)] * 4
corners.publish(found)
for height, width, encoding, data in [
    (0, 0, "bgr8", b"x" * 300), (0, 0, "bgr8", b""), (7, 10, "bgr8", b"x" * 300),
    (10, 11, "bgr8", b"x" * 300), (2, 2, "32FC1", b"x" * 16), (2, 2**31, "mono8", b"x" * 16),
][{{first}}:][:3]:
    pictures.publish(Image(height=height, width=width, encoding=encoding, data=data))
for data in (b"", b"x"):
    packed.publish(CompressedImage(data=data))
"""


@pytest.mark.parametrize("first", [0, 3])
def test_a_picture_that_does_not_fit_its_size_costs_nothing_else(tmp_path, monkeypatch, first):
    ran = _run(tmp_path, monkeypatch, ODD_PICTURES.format(first=first))
    assert ran["error"] is None
    assert [value for _, value in ran["topics"]["/image"]] == [None] * 3
    assert [value for _, value in ran["topics"]["/packed"]] == [None] * 2
    assert ran["topics"]["/corners"][0][1].tolist() == [[1, 2]] * 4


def test_what_lies_beside_the_notebook_is_no_module_of_the_node(tmp_path, monkeypatch):
    for name in ("random", "signal", "json", "course_lib", "numpy"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('not a module of mine')")
    assert _run(tmp_path, monkeypatch, ODD_PICTURES.format(first=0))["error"] is None


def test_hundreds_of_frames_do_not_hide_the_packages_own_files(tmp_path):
    (tmp_path / "frames").mkdir()
    for number in range(400):
        (tmp_path / "frames" / f"{number:03}.png").write_bytes(bytes(100_000))
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "node.py").write_text("import rospy")
    (tmp_path / "package.xml").write_text("<package/>")
    assert {"package.xml", "src/node.py"} < agent._files(str(tmp_path)).keys()


def _run(folder, monkeypatch, node):
    monkeypatch.chdir(folder)
    (folder / "node.py").write_text(node)
    frame = cv2.imencode(".jpg", np.zeros((48, 64, 3), np.uint8))[1].tobytes()
    return node_run.run("node.py", [10**18], [frame], TOPIC, {}, {}, [], timeout=60)
