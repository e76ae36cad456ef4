"""Runs a ROS package on real ROS 1 (Debian's), and gives back what it did as `offline_ros` does.

`Ros` is a master of one's own with whatever is started on it, on the loopback address, in a folder
of its own; leaving it ends and reaps everything::

    with Ros(package_path="solutions") as ros:
        finder = ros.start("roslaunch", "unit4", "example4_5.launch", "template:=well.png")
        ros.run("rosbag", "play", "raw.bag")

`run_launch` plays a recording to what one launch file starts, picture by picture, each when the
one before has been dealt with, so that two runs give the same.

ROS runs under Debian's Python. Nothing here imports it: what must run there is in `player`.
"""

from __future__ import annotations

from course_lib.real_ros.core import Ros
from course_lib.real_ros.processes import Program, RosError
from course_lib.real_ros.runner import run_launch
from course_lib.real_ros.system import complaint

__all__ = ["Program", "Ros", "RosError", "complaint", "run_launch"]
