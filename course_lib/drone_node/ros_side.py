#!/usr/bin/env python3
"""The half of the drone's node that speaks ROS; `python -m course_lib.drone_node` starts it.

Subscribes to /cmd_vel (geometry_msgs/Twist) and publishes
  /camera/rgb/image_raw    sensor_msgs/Image, bgr8
  /camera/rgb/camera_info  sensor_msgs/CameraInfo
  /drone/pose              geometry_msgs/PoseStamped: where the drone is, metres
  /drone/well              geometry_msgs/PolygonStamped: the well's true outline in the picture,
                           in pixels; no points when it is out of view
"""

from __future__ import annotations

import json
import math
import socket
import struct
import sys
import threading
from typing import Any

import rosgraph
import rospy
from geometry_msgs.msg import Point32, PolygonStamped, PoseStamped, Twist
from sensor_msgs.msg import CameraInfo, Image

FRAME_ID = "camera_rgb_optical_frame"


class RosSide:
    """Passes messages between a socket and ROS.

    Parameters
    ----------
    link : socket
        To the process that flies.
    """

    def __init__(self, link: socket.socket) -> None:
        self._link = link
        camera = "/camera/rgb"
        self._image = rospy.Publisher(f"{camera}/image_raw", Image, queue_size=1)
        self._info = rospy.Publisher(f"{camera}/camera_info", CameraInfo, queue_size=1)
        self._pose = rospy.Publisher("/drone/pose", PoseStamped, queue_size=1)
        self._well = rospy.Publisher("/drone/well", PolygonStamped, queue_size=1)
        rospy.Subscriber("/cmd_vel", Twist, self._steer, queue_size=1)

    def _steer(self, twist: Twist) -> None:
        values = (twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.z)
        if not all(math.isfinite(value) for value in values):
            rospy.logwarn("a command that is no number was left out: %s", values)
            return
        self._link.sendall(struct.pack("<4d", *values))

    def _exactly(self, count: int) -> bytes:
        chunks = []
        while count:
            chunk = self._link.recv(min(count, 1 << 20))
            if not chunk:
                raise EOFError
            chunks.append(chunk)
            count -= len(chunk)
        return b"".join(chunks)

    def relay(self) -> None:
        """Publish every picture that comes, until the other side or ROS ends."""
        try:
            while not rospy.is_shutdown():
                about_size, picture_size = struct.unpack("<II", self._exactly(8))
                about = json.loads(self._exactly(about_size))
                self._publish(about, self._exactly(picture_size))
        except (EOFError, OSError, rospy.ROSException):
            rospy.signal_shutdown("the simulator has ended")

    def _publish(self, about: dict[str, Any], pixels: bytes) -> None:
        image = Image(width=about["width"], height=about["height"], encoding="bgr8", data=pixels)
        image.step = 3 * image.width
        info = CameraInfo(width=image.width, height=image.height, distortion_model="plumb_bob")
        (fx, _, cx), (_, fy, cy), _ = about["K"]
        info.D, info.K = [0.0] * 5, [fx, 0, cx, 0, fy, cy, 0, 0, 1]
        info.R = [1, 0, 0, 0, 1, 0, 0, 0, 1]
        info.P = [fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0]
        pose = PoseStamped()
        place, turn = pose.pose.position, pose.pose.orientation
        place.x, place.y, place.z = about["position"]
        turn.z, turn.w = math.sin(about["heading"] / 2), math.cos(about["heading"] / 2)
        well = PolygonStamped()
        well.polygon.points = [Point32(x, y, 0) for x, y in about["well"]]
        now = rospy.Time.now()
        for message in (image, info, well, pose):
            message.header.stamp, message.header.frame_id = now, FRAME_ID
        pose.header.frame_id = "world"
        for publisher, message in (
            (self._well, well),
            (self._pose, pose),
            (self._info, info),
            (self._image, image),
        ):
            publisher.publish(message)


def main() -> None:
    """Connect the socket, whose number is the first argument, with ROS."""
    if not rosgraph.is_master_online():
        sys.exit(f"There is no ROS master at {rosgraph.get_master_uri()}: start roscore first.")
    rospy.init_node("drone")
    side = RosSide(socket.socket(fileno=int(rospy.myargv()[1])))
    threading.Thread(target=side.relay, daemon=True).start()
    rospy.loginfo("the drone flies; steer it over %s", rospy.resolve_name("/cmd_vel"))
    rospy.spin()


if __name__ == "__main__":
    main()
