#!/usr/bin/env python3
"""Example 4.5: find an object in a drone's camera stream.

Parameters (private):
  ~image_topic  sensor_msgs/Image to watch (default /camera/rgb/image_raw)
  ~template     picture of the object, a file; a relative name is looked up beside this node,
                in its package and in the working folder (default waterhole.png)
  ~match_count  how many of the best matches to use (default 100)
  ~show         open a window, where there is a display (default false)

Publishes /object/image (sensor_msgs/Image: the frame, the object outlined) and /object/corners
(geometry_msgs/PolygonStamped, in pixels, with the frame's stamp; no points: not found) and
/object/inliers (std_msgs/Int32: how many matches agree on where the object is).
"""

import os
from pathlib import Path

import cv2
import numpy as np
import rospy
from cv_bridge import CvBridge, CvBridgeError
from geometry_msgs.msg import Point32, PolygonStamped
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


class ObjectNode:
    """Connects the finder to the camera's topic."""

    def __init__(self):
        template_file = find_file(rospy.get_param("~template", "waterhole.png"))
        template = cv2.imread(str(template_file))
        if template is None:
            raise ValueError(f"{template_file} is not a picture")
        self.finder = ObjectFinder(template, rospy.get_param("~match_count", 100))
        self.show = rospy.get_param("~show", default=False) and "DISPLAY" in os.environ
        if self.show:
            rospy.on_shutdown(cv2.destroyAllWindows)
        self.bridge = CvBridge()
        self.image_publisher = rospy.Publisher("/object/image", Image, queue_size=1)
        self.corners_publisher = rospy.Publisher("/object/corners", PolygonStamped, queue_size=1)
        self.inliers_publisher = rospy.Publisher("/object/inliers", Int32, queue_size=1)
        topic = rospy.get_param("~image_topic", "/camera/rgb/image_raw")
        # A picture is bigger than the default buffer: without buff_size old ones pile up there.
        rospy.Subscriber(topic, Image, self.on_image, queue_size=1, buff_size=2**24)
        rospy.loginfo("looking for %s on %s", template_file.name, topic)

    def on_image(self, message):
        """Look for the object in one frame and publish what was found."""
        try:
            frame = self.bridge.imgmsg_to_cv2(message, "bgr8")
        except (CvBridgeError, TypeError, ValueError) as error:  # cut short, or no picture at all
            rospy.logerr("frame left out: %s", error)
            return
        if frame is None or frame.size == 0:
            rospy.logerr("frame left out: it has no pixels")
            return
        corners, inliers = self.finder.find(frame)

        polygon = PolygonStamped(header=message.header)
        if corners is not None:
            polygon.polygon.points = [Point32(x, y, 0) for x, y in corners.tolist()]
            outline = np.int32(np.rint(corners))[:, None]
            cv2.polylines(frame, [outline], isClosed=True, color=(0, 255, 0), thickness=3)
        self.corners_publisher.publish(polygon)
        self.inliers_publisher.publish(inliers)
        outlined = self.bridge.cv2_to_imgmsg(frame, "bgr8")
        outlined.header = message.header
        self.image_publisher.publish(outlined)

        if self.show:
            cv2.imshow("object", frame)
            cv2.waitKey(1)


if __name__ == "__main__":
    rospy.init_node("example4_5")
    ObjectNode()
    rospy.spin()
