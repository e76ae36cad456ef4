#!/usr/bin/env python3
"""Publishes the grey mean of each picture's top left block, and a turned picture."""

import cv2
import rospy
from cv_bridge import CvBridge
from sensor_msgs.msg import Image
from std_msgs.msg import Float32

bridge = CvBridge()


def on_image(message):
    picture = bridge.imgmsg_to_cv2(message, desired_encoding="bgr8")
    rospy.loginfo("frame %d of %s", message.header.seq, message.header.frame_id)
    means.publish(float(picture[2:14, 2:14].mean()))
    turned = bridge.cv2_to_imgmsg(cv2.rotate(picture, cv2.ROTATE_180), encoding="bgr8")
    turned.header = message.header
    images.publish(turned)


rospy.init_node("subscriber", anonymous=True)
means = rospy.Publisher("~mean", Float32, queue_size=10)
images = rospy.Publisher("turned", Image, queue_size=1)
rospy.Subscriber("/camera/rgb/image_raw", Image, on_image)
rospy.spin()
