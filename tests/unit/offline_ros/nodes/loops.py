"""Loops in the way that ~kind says."""

import threading
import time

import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import Int32

count = 0


def on_image(_message):
    global count  # noqa: PLW0603
    count += 1
    pub.publish(count)


def worker():
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        ticks.publish(count)
        rate.sleep()


rospy.init_node("loops")
kind = rospy.get_param("~kind")
pub = rospy.Publisher("/count", Int32, queue_size=1)
ticks = rospy.Publisher("/ticks", Int32, queue_size=1)
rospy.Subscriber("/camera/rgb/image_raw", Image, on_image)

if kind == "polling":  # waits for nothing but asks
    while not rospy.is_shutdown():
        pass
elif kind == "time.sleep":  # ignores the shutdown
    while True:
        time.sleep(0.05)
elif kind == "deaf":  # no sign of life at all
    while True:
        pass
elif kind == "thread":
    threading.Thread(target=worker, daemon=True).start()
    rospy.spin()
elif kind == "join":
    thread = threading.Thread(target=worker)
    thread.start()
    thread.join()
