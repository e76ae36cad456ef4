#!/usr/bin/env python3
"""Exercise 4.2, first node: take a picture with the drone's camera and save it.

Parameters (private):
  ~image_topic  sensor_msgs/Image to take it from (default /camera/rgb/image_raw)
  ~output       the file (default waterhole_frame.png in the working folder)
  ~delay        seconds to wait first, for the drone to fly there (default 0)
  ~timeout      seconds to wait for a picture (default 30)
"""

import sys
from pathlib import Path

import cv2
import rospy
from cv_bridge import CvBridge, CvBridgeError
from sensor_msgs.msg import Image


def take_picture(topic, timeout):
    """Give the next picture that comes on a topic, BGR; None when none came in time."""
    deadline = rospy.get_time() + timeout
    while (left := deadline - rospy.get_time()) > 0:
        try:
            ### BEGIN SOLUTION: wait for one message with rospy.wait_for_message, and convert it
            message = rospy.wait_for_message(topic, Image, timeout=left)
            return CvBridge().imgmsg_to_cv2(message, "bgr8")
            ### END SOLUTION
        except (CvBridgeError, TypeError, ValueError) as error:  # cut short, or no picture at all
            rospy.logwarn("a broken picture, waiting for the next: %s", error)
        except rospy.ROSInterruptException:  # Ctrl-C
            return None
        except rospy.ROSException:  # nothing came in time
            break
    return None


def save_picture(picture, file):
    """Write a picture; tell whether that went well."""
    try:
        ### BEGIN SOLUTION: cv2.imwrite tells whether it could: return that
        return cv2.imwrite(str(file), picture)
        ### END SOLUTION
    except cv2.error:  # the name ends in nothing that OpenCV can write
        return False


def main():
    rospy.init_node("exercise4_2_1")
    topic = rospy.get_param("~image_topic", "/camera/rgb/image_raw")
    file = Path(rospy.get_param("~output", "waterhole_frame.png")).expanduser().absolute()
    delay = rospy.get_param("~delay", 0)
    if delay > 0:
        rospy.sleep(delay)

    timeout = rospy.get_param("~timeout", 30)
    picture = take_picture(topic, timeout)
    if picture is None:
        sys.exit(f"no picture on {topic} in {timeout} s. Does `rostopic hz {topic}` see any?")
    if not save_picture(picture, file):
        sys.exit(f"cannot write {file}. Does its folder exist, and does it end in .png or .jpg?")
    rospy.loginfo("saved %s, %d x %d", file, picture.shape[1], picture.shape[0])


if __name__ == "__main__":
    main()
