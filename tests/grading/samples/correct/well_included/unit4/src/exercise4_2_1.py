#!/usr/bin/env python3
# -*- coding: utf-8 -*-
"""Macht ein Foto."""
import os
import rospy
import cv2
from cv_bridge import CvBridge
from sensor_msgs.msg import Image

class Fotograf(object):
    def __init__(self):
        self.fertig = False
        self.bruecke = CvBridge()
        self.ziel = os.path.expanduser(rospy.get_param("~output", "~/Bilder/unit4/foto.jpg"))
        if not os.path.isdir(os.path.dirname(self.ziel)):
            os.makedirs(os.path.dirname(self.ziel))
        self.sub = rospy.Subscriber("/camera/rgb/image_raw", Image, self.bild)

    def bild(self, msg):
        if self.fertig: return
        cv2.imwrite(self.ziel, self.bruecke.imgmsg_to_cv2(msg, desired_encoding="bgr8"), [cv2.IMWRITE_JPEG_QUALITY, 95])
        self.fertig = True
        self.sub.unregister()
        rospy.loginfo("gespeichert: %s", self.ziel)
        rospy.signal_shutdown("fertig")

if __name__ == "__main__":
    rospy.init_node("fotograf", anonymous=True, log_level=rospy.DEBUG)
    Fotograf()
    rospy.spin()
