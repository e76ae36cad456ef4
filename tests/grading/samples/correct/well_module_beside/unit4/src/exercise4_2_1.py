#!/usr/bin/env python3
import numpy as np
import cv2
import rospy
from sensor_msgs.msg import Image


class Photo:
    """Prend la premiere image apres un delai."""

    def __init__(self):
        self.fichier = rospy.get_param("~output", "/tmp/well.png")
        self.debut = rospy.get_rostime() + rospy.Duration(rospy.get_param("~delay", 0))
        self.fini = False
        self.sub = rospy.Subscriber(name=rospy.get_param("~image_topic", "/camera/rgb/image_raw"), data_class=Image, callback=self.prendre, queue_size=1)

    def prendre(self, msg):
        if self.fini or rospy.get_rostime() < self.debut:
            return
        image = np.ndarray(shape=(msg.height, msg.width, 3), dtype=np.uint8, buffer=msg.data)
        if msg.encoding.startswith("rgb"):
            image = cv2.cvtColor(image, cv2.COLOR_RGB2BGR)
        self.fini = cv2.imwrite(self.fichier, image)
        if self.fini:
            rospy.loginfo("Photo %s", self.fichier)
            rospy.signal_shutdown("fini")


if __name__ == "__main__":
    rospy.init_node("photo")
    photo = Photo()
    rospy.spin()
