#!/usr/bin/python3
import argparse, pathlib, sys
import message_filters
import rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import Point32, PolygonStamped
from sensor_msgs.msg import Image
import cv2
import numpy as np
orb = cv2.ORB_create(2000)
bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)

def features(image):
    return orb.detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)

def pairs(a, b):
    (ka, da), (kb, db) = a, b
    if da is None or db is None:
        return np.zeros((0, 2), np.float32), np.zeros((0, 2), np.float32)
    m = sorted(bf.match(da, db), key=lambda m: m.distance)
    return (np.float32([ka[i.queryIdx].pt for i in m]).reshape(-1, 2),
            np.float32([kb[i.trainIdx].pt for i in m]).reshape(-1, 2))

def outline(shape, x, y):
    if len(x) < 4:
        return None
    H, mask = cv2.findHomography(x, y, cv2.RANSAC, 5.0)
    if H is None or mask.sum() < 10:
        return None
    h, w = shape[:2]
    c = cv2.perspectiveTransform(np.float32([[[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]]), H)[0]
    return c if cv2.isContourConvex(c) and cv2.contourArea(c, oriented=True) < -0.02 * h * w else None

def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("template", type=pathlib.Path)
    parser.add_argument("-n", "--match-count", type=int, default=58)
    args = parser.parse_args(rospy.myargv()[1:])
    rospy.init_node("waterhole", anonymous=False)
    template = cv2.imread(str(args.template))
    assert template is not None, args.template
    known = features(template)
    bridge = CvBridge()
    corners_pub = rospy.Publisher("waterhole/corners", PolygonStamped, queue_size=1)
    image_pub = rospy.Publisher("waterhole/image", Image, queue_size=1)

    def callback(message):
        frame = bridge.imgmsg_to_cv2(message, "bgr8")
        x, y = pairs(known, features(frame))
        found = outline(template.shape, x[:args.match_count], y[:args.match_count])
        polygon = PolygonStamped()
        polygon.header = message.header
        if found is not None:
            for px, py in found.tolist():
                polygon.polygon.points.append(Point32(x=px, y=py))
            for a, b in zip(found, np.roll(found, -1, axis=0)):
                cv2.line(frame, tuple(int(v) for v in a), tuple(int(v) for v in b), (255, 0, 255), 4, cv2.LINE_AA)
        corners_pub.publish(polygon)
        out = bridge.cv2_to_imgmsg(frame, "bgr8")
        out.header.stamp = message.header.stamp
        image_pub.publish(out)

    subscriber = message_filters.Subscriber("/camera/rgb/image_raw", Image)
    subscriber.registerCallback(callback)
    rospy.spin()

if __name__ == "__main__":
    main()
