#!/usr/bin/python3
import argparse, sys, time
import cv2, rospy
import numpy as np
from sensor_msgs.msg import Image
from cv_bridge import CvBridge

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--output", required=True)
parser.add_argument("--delay", type=float, default=0.0)

def main(argv):
    args = parser.parse_args(argv[1:])
    rospy.init_node("take_picture")
    start = rospy.Time.now()
    while not rospy.is_shutdown() and (rospy.Time.now() - start).to_sec() < args.delay:
        rospy.sleep(0.1)
    image = CvBridge().imgmsg_to_cv2(rospy.wait_for_message("/camera/rgb/image_raw", Image, 60), "bgr8")
    return 0 if cv2.imwrite(args.output, image) else 1

if __name__ == "__main__":
    sys.exit(main(rospy.myargv(argv=sys.argv)))
