"""What a student's node saved is found wherever the exercise lets it save."""

from __future__ import annotations

import os
import time

import cv2
import numpy as np
import pytest

from course_lib.grading import node_run

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
