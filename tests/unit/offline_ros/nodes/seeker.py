#!/usr/bin/env python3
"""Turns the drone until it sees the well, and then flies to it for a while."""

import cv2
import numpy as np
import rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Image
from std_msgs.msg import String


class Seeker:
    def __init__(self):
        template = cv2.imread(rospy.get_param("~template"), cv2.IMREAD_GRAYSCALE)
        self.orb = cv2.ORB_create(1000)
        self.matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
        self.template = self.orb.detectAndCompute(template, None)
        self.bridge = CvBridge()
        self.sees = False
        self.velocity = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        self.story = rospy.Publisher("/seeker/story", String, queue_size=10)
        rospy.Subscriber("/camera/rgb/image_raw", Image, self.on_image, queue_size=1)
        rospy.Timer(rospy.Duration(0.2), self.steer)

    def on_image(self, message):
        grey = self.bridge.imgmsg_to_cv2(message, "mono8")
        keypoints, descriptors = self.orb.detectAndCompute(grey, None)
        matches = sorted(
            self.matcher.match(self.template[1], descriptors), key=lambda m: m.distance
        )
        source = np.float32([self.template[0][m.queryIdx].pt for m in matches[:60]])
        target = np.float32([keypoints[m.trainIdx].pt for m in matches[:60]])
        _, mask = cv2.findHomography(source, target, cv2.RANSAC, 5.0)
        seen = mask is not None and int(mask.sum()) > 20
        middle = float(target[mask.ravel() > 0, 0].mean()) if seen else -1.0
        self.sees = self.sees or (seen and 200 < middle < 440)
        self.story.publish(f"{message.header.stamp.to_nsec()} {int(seen)} {middle:.0f}")

    def steer(self, _event):
        command = Twist()
        if self.sees:
            command.linear.x = 0.5
        else:
            command.angular.z = 0.5
        self.velocity.publish(command)


if __name__ == "__main__":
    rospy.init_node("seeker")
    Seeker()
    rospy.spin()
