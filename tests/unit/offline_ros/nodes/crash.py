"""Crashes on its third picture, in a function that its callback calls."""

import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import Int32

seen = []


def work(message):
    seen.append(message)
    if len(seen) == 3:
        raise ValueError("third picture is too much")


def on_image(message):
    work(message)
    pub.publish(len(seen))


rospy.init_node("crash")
pub = rospy.Publisher("/count", Int32, queue_size=1)
rospy.Subscriber("/camera/rgb/image_raw", Image, on_image)
rospy.spin()
