#!/usr/bin/env python3
"""Nimmt ein Bild auf und speichert es."""
import os
import threading

import cv2
import rospkg
import rospy
from cv_bridge import CvBridge
from sensor_msgs.msg import Image


class Aufnahme:
    def __init__(self) -> None:
        self.fertig = threading.Event()
        self.bruecke = CvBridge()
        ordner = rospkg.RosPack().get_path("unit4")
        self.ziel = rospy.get_param("~output", os.path.join(ordner, "bild.png"))
        rospy.sleep(rospy.get_param("~delay", 0.0))
        self.abo = rospy.Subscriber(rospy.get_param("~image_topic"), Image, self.bild)

    def bild(self, nachricht: Image) -> None:
        if self.fertig.is_set():
            return
        cv2.imwrite(self.ziel, self.bruecke.imgmsg_to_cv2(nachricht, "bgr8"))
        self.fertig.set()
        self.abo.unregister()
        rospy.loginfo("gespeichert: %s", self.ziel)


if __name__ == "__main__":
    rospy.init_node("aufnahme", anonymous=True)
    aufnahme = Aufnahme()
    while not rospy.is_shutdown() and not aufnahme.fertig.is_set():
        rospy.sleep(0.05)
