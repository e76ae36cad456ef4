"""Runs a ROS 1 node file, unchanged, where no ROS is installed.

A recording (a bag) stands for the robot. From a terminal::

    python -m course_lib.offline_ros finder.py _match_count:=80 --record out.bag

From a notebook::

    recording = run_node("finder.py", params={"match_count": 80})
    for stamp_ns, message in recording["/object/corners"]:
        ...

The node's `import rospy`, `from cv_bridge import CvBridge` and `from sensor_msgs.msg import
Image` find stand-ins that exist only in the process that runs it. What they do not offer, they
refuse by name.
"""

from __future__ import annotations

from course_lib.offline_ros.errors import BagError, NodeError, OfflineRosError, UnsupportedError
from course_lib.offline_ros.recording import LogLine, Recording
from course_lib.offline_ros.runner import run_node

__all__ = [
    "BagError",
    "LogLine",
    "NodeError",
    "OfflineRosError",
    "Recording",
    "UnsupportedError",
    "run_node",
]
