#!/usr/bin/env python3
import os
import cv2, numpy as np
import rospy, roslib.packages
from cv_bridge import CvBridge
from sensor_msgs.msg import Image
from geometry_msgs.msg import PolygonStamped, Point32
from unit4.finder import Sucher


def hauptprogramm():
    rospy.init_node("brunnen")
    ordner = roslib.packages.get_pkg_dir("unit4")
    vorlage = cv2.imread(os.path.join(ordner, rospy.get_param("~vorlage", "waterhole.png")))
    sucher, brücke = Sucher(vorlage), CvBridge()
    bilder = rospy.Publisher("/waterhole/image", Image, queue_size=1)
    ecken_pub = rospy.Publisher("/waterhole/corners", PolygonStamped, queue_size=1)

    def neues_bild(nachricht):
        bild = brücke.imgmsg_to_cv2(nachricht, "bgr8")
        ecken = sucher.suche(bild, rospy.get_param("~anzahl", 58))
        vieleck = PolygonStamped()
        vieleck.header = nachricht.header
        if ecken is not None:
            vieleck.polygon.points = [Point32(*map(float, p), 0) for p in ecken]
            bild = bild.copy()
            cv2.polylines(bild, [ecken.astype(np.int32)], True, (255, 0, 0), 2)
        ecken_pub.publish(vieleck)
        ausgabe = brücke.cv2_to_imgmsg(bild, "bgr8")
        ausgabe.header.stamp = nachricht.header.stamp
        bilder.publish(ausgabe)

    rospy.Subscriber("/camera/rgb/image_raw", Image, neues_bild, queue_size=1, buff_size=2**24)
    rospy.spin()


hauptprogramm()
