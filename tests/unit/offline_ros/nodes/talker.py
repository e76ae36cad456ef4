"""The tutorial's talker: publishes in a loop, five times per second."""

import contextlib

import rospy
from std_msgs.msg import String


def talker():
    pub = rospy.Publisher("chatter", String, queue_size=10)
    rospy.init_node("talker", anonymous=False)
    rate = rospy.Rate(5)
    while not rospy.is_shutdown():
        text = f"hello {rospy.get_time():.1f}"
        rospy.loginfo(text)
        pub.publish(text)
        rate.sleep()


if __name__ == "__main__":
    with contextlib.suppress(rospy.ROSInterruptException):
        talker()
