"""Shows each picture in a window."""

import cv2
import rospy
from cv_bridge import CvBridge
from sensor_msgs.msg import Image


def on_image(message):
    cv2.imshow("camera", CvBridge().imgmsg_to_cv2(message, "bgr8"))
    cv2.waitKey(1)


rospy.init_node("window")
cv2.namedWindow("camera", cv2.WINDOW_NORMAL)
rospy.Subscriber("/camera/rgb/image_raw", Image, on_image, queue_size=1)
rospy.spin()
cv2.destroyAllWindows()
