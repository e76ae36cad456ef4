#!/usr/bin/env python3
import os, threading
import rospy
from cv_bridge import CvBridge, CvBridgeError
from geometry_msgs.msg import Point32, Polygon, PolygonStamped
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

class Sucher:
    def __init__(self):
        p = rospy.get_param("~")
        self.n = int(p["anzahl"]); self.vorlage = cv2.imread(p["vorlage"])
        self.merkmale = features(self.vorlage)
        self.bruecke = CvBridge()
        self.schloss = threading.Lock()
        self.warten = []
        self.p_bild = rospy.Publisher("/waterhole/image", Image, queue_size=10)
        self.p_ecken = rospy.Publisher("/waterhole/corners", PolygonStamped, queue_size=10)
        rospy.Subscriber(p["thema"], Image, self.neu, queue_size=10)
        rospy.Timer(rospy.Duration(0.02), self.arbeite)

    def neu(self, msg):
        with self.schloss:
            self.warten.append(msg)

    def arbeite(self, event):
        with self.schloss:
            alle, self.warten = self.warten, []
        for msg in alle:
            try:
                bild = self.bruecke.imgmsg_to_cv2(msg, "bgr8").copy()
            except CvBridgeError as e:
                rospy.logerr(e); continue
            x, y = pairs(self.merkmale, features(bild))
            ecken = outline(self.vorlage.shape, x[:self.n], y[:self.n])
            punkte = [] if ecken is None else [Point32(float(a), float(b), 0.0) for a, b in ecken]
            self.p_ecken.publish(PolygonStamped(header=msg.header, polygon=Polygon(points=punkte)))
            if ecken is not None:
                cv2.polylines(bild, [ecken.astype(int)], True, (0, 0, 255), 2)
            aus = self.bruecke.cv2_to_imgmsg(bild, encoding="bgr8"); aus.header = msg.header
            self.p_bild.publish(aus)

if __name__ == "__main__":
    try:
        rospy.init_node("sucher")
        Sucher()
        rospy.spin()
    except rospy.ROSInterruptException:
        pass
