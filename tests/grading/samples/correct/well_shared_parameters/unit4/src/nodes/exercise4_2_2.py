#!/usr/bin/env python
"""The newest frame, thirty times a second. Its topics and parameters are those of its namespace."""
import threading
import cv2, numpy as np, rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import Point32, PolygonStamped
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import Image

orb, lock, newest = cv2.ORB_create(1500), threading.Lock(), []

def keep(message):
    with lock:
        newest[:] = [message]

def outline(template, features, frame, n):
    kp, des = orb.detectAndCompute(frame, None)
    if des is None: return None
    best = sorted(cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(features[1], des), key=lambda m: m.distance)[:n]
    if len(best) < 10: return None
    H, mask = cv2.findHomography(np.float32([features[0][m.queryIdx].pt for m in best]),
                                 np.float32([kp[m.trainIdx].pt for m in best]), cv2.RANSAC, 5.0)
    if H is None or mask.sum() < 10: return None
    h, w = template.shape[:2]
    q = cv2.perspectiveTransform(np.float32([[[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]]), H)[0]
    return q if cv2.isContourConvex(q) and cv2.contourArea(q, oriented=True) < -800 else None

rospy.init_node("finder")
template = cv2.imread(rospy.get_param("template"))
features, n, bridge = orb.detectAndCompute(template, None), rospy.get_param("/unit4/n"), CvBridge()
pictures = rospy.Publisher("image", Image, queue_size=1)
polygons = rospy.Publisher("corners", PolygonStamped, queue_size=1)
rospy.Subscriber("frames", numpy_msg(Image), keep, queue_size=1, buff_size=2**24)
rate = rospy.Rate(30)
while not rospy.is_shutdown():
    with lock:
        message = newest.pop() if newest else None
    if message:
        frame = bridge.imgmsg_to_cv2(message, "bgr8").copy()
        q = outline(template, features, frame, n)
        polygon = PolygonStamped(header=message.header)
        if q is not None:
            polygon.polygon.points = [Point32(x, y, 0) for x, y in q.tolist()]
            cv2.polylines(frame, [np.int32(q)], True, (0, 0, 255), 3)
        polygons.publish(polygon)
        if pictures.get_num_connections():
            picture = bridge.cv2_to_imgmsg(frame, "bgr8")
            picture.header = message.header
            pictures.publish(picture)
    rate.sleep()
