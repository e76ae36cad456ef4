#!/usr/bin/env python3
"""Exercise 4.2, second node: find the waterhole in the drone's camera stream.

Parameters (private):
  ~image_topic  sensor_msgs/Image to watch (default /camera/rgb/image_raw)
  ~template     picture of the waterhole, a file; a relative name is looked up beside this node,
                in its package and in the working folder (default waterhole.png)
  ~match_count  how many of the best matches to use (default: what best_match_count found)
  ~show         open a window, where there is a display (default false)

Publishes /waterhole/image (sensor_msgs/Image: the frame, the waterhole outlined) and
/waterhole/corners (geometry_msgs/PolygonStamped, in pixels, with the frame's stamp; no points:
not found).
"""

import os
from pathlib import Path

import cv2
import numpy as np
import rospy
from cv_bridge import CvBridge, CvBridgeError
from geometry_msgs.msg import Point32, PolygonStamped
from sensor_msgs.msg import Image

raise NotImplementedError("MATCH_COUNT = the number that best_match_count found")

# From here on, the notebook's functions: it puts them here.


def find_keypoints(image):
    """Return the ORB keypoints of a BGR picture, and their descriptors."""
    raise NotImplementedError("step 3: convert to grey, then ORB's detectAndCompute")


def match_points(template_features, frame_features):
    """Return matched points, in the template and in the frame, best first; each (N, 2)."""
    raise NotImplementedError("step 3: match, sort by distance, collect both points of each match")


def fit_outline(shape, points_template, points_frame):
    """Return the corners of a picture of this shape in the frame, (4, 2), or None."""
    raise NotImplementedError("step 3: findHomography, then the corners; None unless it is believable")


# Up to here, the notebook's functions.


def find_file(name):
    """Give the path of a file named relative to the node, its package or the working folder."""
    here = Path(__file__).resolve().parent
    for folder in (here, here.parent, Path.cwd()):
        if (folder / name).is_file():
            return folder / name
    raise FileNotFoundError(
        f"no template {name!r} in {here}, above it or in {Path.cwd()}. Exercise 4.2's notebook "
        "saves it as unit4/waterhole.png; or name another file with template:=…"
    )


class WaterholeNode:
    """Connects the notebook's functions to the camera's topic."""

    def __init__(self):
        file = find_file(rospy.get_param("~template", "waterhole.png"))
        self.template = cv2.imread(str(file))
        if self.template is None:
            raise ValueError(f"{file} is not a picture. Save the template anew.")
        self.match_count = rospy.get_param("~match_count", MATCH_COUNT)
        self.show = rospy.get_param("~show", default=False) and "DISPLAY" in os.environ
        if self.show:
            rospy.on_shutdown(cv2.destroyAllWindows)
        self.bridge = CvBridge()
        topic = rospy.get_param("~image_topic", "/camera/rgb/image_raw")
        raise NotImplementedError("the template's features, two publishers, and last the subscriber")
        rospy.loginfo("looking for %s on %s", file.name, topic)

    def on_image(self, message):
        """Look for the waterhole in one frame and publish what was found."""
        try:
            frame = self.bridge.imgmsg_to_cv2(message, "bgr8")
        except (CvBridgeError, TypeError, ValueError) as error:  # cut short, or no picture at all
            rospy.logerr("frame left out: %s", error)
            return
        if frame is None or frame.size == 0:
            rospy.logerr("frame left out: it has no pixels")
            return
        corners = self.find(frame)
        self.publish(message.header, frame, corners)
        if self.show:
            cv2.imshow("waterhole", frame)
            cv2.waitKey(1)

    def find(self, frame):
        """Give the waterhole's corners in a BGR frame, (4, 2), or None."""
        raise NotImplementedError("match self.features with the frame's, then fit_outline")

    def publish(self, header, frame, corners):
        """Publish corners as a polygon (None: no points), and the frame with their outline."""
        raise NotImplementedError("a PolygonStamped and an Image, both with the frame's own header")


if __name__ == "__main__":
    rospy.init_node("exercise4_2_2")
    WaterholeNode()
    rospy.spin()
