#!/usr/bin/env python3
"""Example 4.5 for ROS 2: find an object in a drone's camera stream.

The counterpart of solutions/unit4/src/example4_5.py: how the object is found is the same, word for
word; how the node talks to ROS differs. It has not been run by us: see notebook 4.5.

    python3 example4_5.py --ros-args -p template:=/home/me/waterhole.png -p match_count:=100

Parameters:
  image_topic  sensor_msgs/msg/Image to watch (default /camera/rgb/image_raw)
  template     picture of the object, a file; a relative name is looked up beside this node,
               above it and in the working folder (default waterhole.png)
  match_count  how many of the best matches to use (default 100)
  show         open a window, where there is a display (default false)

Publishes /object/image, /object/corners and /object/inliers, as the ROS 1 node does.
"""

import os
from pathlib import Path

import cv2
import numpy as np
import rclpy
from cv_bridge import CvBridge, CvBridgeError
from geometry_msgs.msg import Point32, PolygonStamped
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image
from std_msgs.msg import Int32

MIN_INLIERS = 10  # by chance, eight or nine matches agree on a frame of hedges


def find_file(name):
    """Give the path of a file named relative to the node, its package or the working folder."""
    here = Path(__file__).resolve().parent
    for folder in (here, here.parent, Path.cwd()):
        if (folder / name).is_file():
            return folder / name
    raise FileNotFoundError(f"no file {name!r} in {here}, above it or in {Path.cwd()}")


class ObjectFinder:
    """Finds one flat object in pictures."""

    def __init__(self, template, match_count):
        self.match_count = match_count
        self.orb = cv2.ORB_create(nfeatures=1000)
        self.matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
        # The template never changes: its features are computed once, not for every frame.
        gray = cv2.cvtColor(template, cv2.COLOR_BGR2GRAY)
        self.keypoints, self.descriptors = self.orb.detectAndCompute(gray, None)
        if self.descriptors is None:
            raise ValueError("the template has no keypoints")
        h, w = gray.shape
        self.outline = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]])

    def find(self, frame):
        """Give the object's corners in a BGR frame (None: not there) and the number of inliers."""
        gray = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
        keypoints, descriptors = self.orb.detectAndCompute(gray, None)
        if descriptors is None:  # sky, fog, a wall: nothing to match
            return None, 0
        matches = self.matcher.match(self.descriptors, descriptors)
        matches = sorted(matches, key=lambda match: match.distance)[: self.match_count]
        if len(matches) < 4:  # a homography needs four points
            return None, 0
        source = np.float32([self.keypoints[m.queryIdx].pt for m in matches])
        target = np.float32([keypoints[m.trainIdx].pt for m in matches])
        homography, mask = cv2.findHomography(source, target, cv2.RANSAC, 5.0)
        if homography is None:
            return None, 0
        inliers = int(mask.sum())
        corners = cv2.perspectiveTransform(self.outline[:, None], homography)[:, 0]
        return (corners if inliers >= MIN_INLIERS and self.plausible(corners) else None), inliers

    def plausible(self, corners):
        """Tell whether this can be the object: a wrong homography folds or bloats its outline."""
        if not np.isfinite(corners).all() or not cv2.isContourConvex(corners):
            return False
        before, after = (cv2.contourArea(c, oriented=True) for c in (self.outline, corners))
        return 0.01 < after / before < 100  # below zero: mirrored


class ObjectNode(Node):
    """Connects the finder to the camera's topic."""

    def __init__(self):
        super().__init__("example4_5")
        template_file = find_file(self.declare_parameter("template", "waterhole.png").value)
        template = cv2.imread(str(template_file))
        if template is None:
            raise ValueError(f"{template_file} is not a picture")
        self.finder = ObjectFinder(template, self.declare_parameter("match_count", 100).value)
        self.show = self.declare_parameter("show", value=False).value and "DISPLAY" in os.environ
        self.bridge = CvBridge()
        self.image_publisher = self.create_publisher(Image, "/object/image", 1)
        self.corners_publisher = self.create_publisher(PolygonStamped, "/object/corners", 1)
        self.inliers_publisher = self.create_publisher(Int32, "/object/inliers", 1)
        topic = self.declare_parameter("image_topic", "/camera/rgb/image_raw").value
        # Cameras send at best effort; who asks for more than is offered hears nothing.
        newest = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.create_subscription(Image, topic, self.on_image, newest)
        self.get_logger().info(f"looking for {template_file.name} on {topic}")

    def on_image(self, message):
        """Look for the object in one frame and publish what was found."""
        try:
            frame = self.bridge.imgmsg_to_cv2(message, "bgr8")
        except (CvBridgeError, TypeError, ValueError) as error:  # cut short, or no picture at all
            self.get_logger().error(f"frame left out: {error}")
            return
        if frame is None or frame.size == 0:
            self.get_logger().error("frame left out: it has no pixels")
            return
        corners, inliers = self.finder.find(frame)

        polygon = PolygonStamped(header=message.header)
        if corners is not None:
            polygon.polygon.points = [Point32(x=x, y=y, z=0.0) for x, y in corners.tolist()]
            outline = np.int32(np.rint(corners))[:, None]
            cv2.polylines(frame, [outline], isClosed=True, color=(0, 255, 0), thickness=3)
        self.corners_publisher.publish(polygon)
        self.inliers_publisher.publish(Int32(data=inliers))
        outlined = self.bridge.cv2_to_imgmsg(frame, "bgr8")
        outlined.header = message.header
        self.image_publisher.publish(outlined)

        if self.show:
            cv2.imshow("object", frame)
            cv2.waitKey(1)


def main():
    rclpy.init()
    node = ObjectNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
