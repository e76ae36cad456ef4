#!/usr/bin/env python3
"""What the unit's Example 4.5 does in its callback, on the topics of ours, for comparison.

The template is read and described anew for each frame, and so are the detector and the matcher.
Corrected is only what would keep it from running: the callback's name, COLOR_BGR2GRAY, checks for
None. It subscribes as the unit does, without `queue_size` and `buff_size`.
"""

import cv2
import numpy as np
import rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import Point32, PolygonStamped
from sensor_msgs.msg import Image


def locate(template_file, frame):
    template = cv2.imread(template_file)
    height, width = template.shape[:2]
    orb = cv2.ORB_create(nfeatures=1000)
    train_keypoints, train = orb.detectAndCompute(cv2.cvtColor(template, cv2.COLOR_BGR2GRAY), None)
    query_keypoints, query = orb.detectAndCompute(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY), None)
    if query is None:
        return None
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    good = sorted(matcher.match(train, query), key=lambda match: match.distance)[:100]
    if len(good) < 4:
        return None
    source = np.float32([train_keypoints[m.queryIdx].pt for m in good]).reshape(-1, 1, 2)
    target = np.float32([query_keypoints[m.trainIdx].pt for m in good]).reshape(-1, 1, 2)
    homography, _ = cv2.findHomography(source, target, cv2.RANSAC, 5.0)
    if homography is None:
        return None
    corners = np.float32([[0, 0], [0, height - 1], [width - 1, height - 1], [width - 1, 0]])
    return cv2.perspectiveTransform(corners.reshape(-1, 1, 2), homography).reshape(4, 2)


def on_image(message):
    frame = bridge.imgmsg_to_cv2(message, "bgr8")
    corners = locate(template_file, frame)
    polygon = PolygonStamped(header=message.header)
    if corners is not None:
        polygon.polygon.points = [Point32(x, y, 0) for x, y in corners.tolist()]
        cv2.polylines(frame, [np.int32(corners).reshape(-1, 1, 2)], True, (0, 255, 0), 3)
    corners_publisher.publish(polygon)
    image_publisher.publish(bridge.cv2_to_imgmsg(frame, "bgr8"))


rospy.init_node("callback")
template_file = rospy.get_param("~template")
bridge = CvBridge()
corners_publisher = rospy.Publisher("/object/corners", PolygonStamped, queue_size=1)
image_publisher = rospy.Publisher("/object/image", Image, queue_size=1)
rospy.Subscriber("/camera/rgb/image_raw", Image, on_image)
rospy.spin()
