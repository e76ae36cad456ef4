#!/usr/bin/env python3
import os
import sys
import cv2
import numpy as np
import rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import Point32, Polygon, PolygonStamped
from sensor_msgs.msg import Image
from std_msgs.msg import Header

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from puits import corners_for, mutual, racine


class Noeud:
    def __init__(self):
        modele = cv2.imread(rospy.get_param("~modele"))
        self.forme = modele.shape
        self.kp, self.des = racine(modele)
        self.n = rospy.get_param("~nombre", 58)
        self.pont = CvBridge()
        self.pubs = {
            "image": rospy.Publisher("~image", Image, queue_size=2, tcp_nodelay=True),
            "corners": rospy.Publisher("~corners", PolygonStamped, queue_size=2),
        }
        self.sub = rospy.Subscriber("image_raw", Image, callback=lambda m: self.traiter(m), queue_size=None)
        rospy.on_shutdown(lambda: rospy.loginfo("fin"))

    def traiter(self, m):
        try:
            image = self.pont.imgmsg_to_cv2(m, desired_encoding="bgr8")
        except Exception as e:
            rospy.logwarn("%s", e)
            return
        kp, des = racine(image)
        coins = corners_for(self.forme, self.kp, kp, mutual(self.des, des), [self.n])[self.n]
        tete = Header()
        tete.stamp, tete.frame_id = m.header.stamp, "camera"
        points = []
        if coins is not None:
            points = [Point32(x=float(x), y=float(y), z=0.0) for (x, y) in coins]
            for p in points:
                cv2.circle(image, (int(p.x), int(p.y)), 6, (0, 0, 255), -1)
            for a, b in zip(points, points[1:] + points[:1]):
                cv2.line(image, (int(a.x), int(a.y)), (int(b.x), int(b.y)), (0, 0, 255), 3)
        self.pubs["corners"].publish(header=tete, polygon=Polygon(points=points))
        sortie = Image()
        sortie.header = tete
        sortie.height, sortie.width = image.shape[:2]
        sortie.encoding = "bgr8"
        sortie.is_bigendian = 0
        sortie.step = 3 * sortie.width
        sortie.data = image.tobytes()
        self.pubs["image"].publish(sortie)


if __name__ == "__main__":
    rospy.init_node("waterhole")
    noeud = Noeud()
    rospy.spin()
