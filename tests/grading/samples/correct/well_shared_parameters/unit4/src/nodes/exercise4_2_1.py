#!/usr/bin/env python
import os
import cv2, message_filters, rospy
from cv_bridge import CvBridge
from sensor_msgs.msg import Image

def save(message):
    path = os.path.expanduser(rospy.get_param("/unit4/output"))
    if not os.path.isdir(os.path.dirname(path)):
        os.makedirs(os.path.dirname(path))
    cv2.imwrite(path, CvBridge().imgmsg_to_cv2(message, "bgr8"))
    rospy.signal_shutdown("saved " + path)

rospy.init_node("shot", disable_signals=True)
cache = message_filters.Cache(message_filters.Subscriber(rospy.get_param("unit4/topic"), Image), 5)
cache.registerCallback(save)
rospy.spin()
