#!/usr/bin/env python3
"""Sucht den Brunnen im Bilderstrom der Drohne."""
from __future__ import annotations

import os

import cv2
import numpy as np
import rospkg
import rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import Point32, PolygonStamped
from sensor_msgs.msg import Image


class Finder:
    def __init__(self, vorlage: np.ndarray, n: int) -> None:
        self.sift = cv2.SIFT_create(contrastThreshold=0.03)
        self.flann = cv2.FlannBasedMatcher(dict(algorithm=1, trees=5), dict(checks=80))
        self.vorlage, self.n = vorlage, n
        self.kp, self.des = self.sift.detectAndCompute(vorlage, None)

    def __call__(self, bild: np.ndarray) -> np.ndarray | None:
        kp, des = self.sift.detectAndCompute(bild, None)
        if des is None or len(des) < 2:
            return None
        gut = []
        for beide in self.flann.knnMatch(self.des, des, k=2):
            if len(beide) == 2 and beide[0].distance < 0.77 * beide[1].distance:
                gut.append(beide[0])
        gut = sorted(gut, key=lambda m: m.distance)[: self.n]
        if len(gut) < 10:
            return None
        a = np.float32([self.kp[m.queryIdx].pt for m in gut])
        b = np.float32([kp[m.trainIdx].pt for m in gut])
        H, maske = cv2.findHomography(a, b, cv2.RANSAC, 5.0)
        if H is None or int(maske.sum()) < 10:
            return None
        h, w = self.vorlage.shape[:2]
        ecken = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]).reshape(-1, 1, 2)
        ecken = cv2.perspectiveTransform(ecken, H)
        if not cv2.isContourConvex(ecken) or cv2.contourArea(ecken, True) > -200:
            return None
        return ecken.reshape(4, 2)


class Knoten:
    def __init__(self) -> None:
        parameter = rospy.get_param("~")
        ordner = rospkg.RosPack().get_path("unit4")
        vorlage = cv2.imread(os.path.join(ordner, parameter["template"]), cv2.IMREAD_COLOR)
        self.finder = Finder(vorlage, parameter["match_count"])
        self.bruecke = CvBridge()
        self.bild_aus = rospy.Publisher("/waterhole/image", Image, queue_size=5)
        self.ecken_aus = rospy.Publisher("/waterhole/corners", PolygonStamped, queue_size=5)
        rospy.Subscriber(parameter["image_topic"], Image, self.bild)

    def bild(self, nachricht: Image) -> None:
        bild = self.bruecke.imgmsg_to_cv2(nachricht, desired_encoding="bgr8")
        ecken = self.finder(bild)
        aus = PolygonStamped()
        aus.header = nachricht.header
        if ecken is not None:
            for x, y in ecken:
                aus.polygon.points.append(Point32(float(x), float(y), 0.0))
            bild = cv2.polylines(bild, [np.int32(ecken)], True, (0, 0, 255), 2, cv2.LINE_AA)
        self.ecken_aus.publish(aus)
        heraus = self.bruecke.cv2_to_imgmsg(bild, "bgr8")
        heraus.header = nachricht.header
        self.bild_aus.publish(heraus)


def main() -> None:
    rospy.init_node("brunnen")
    Knoten()
    rospy.spin()


if __name__ == "__main__":
    main()
