import build

NODE = """#!/usr/bin/env python3
import random
import rospy
from geometry_msgs.msg import Point32, PolygonStamped
from sensor_msgs.msg import Image

def found(picture):
    corners = PolygonStamped(header=picture.header)
    corners.polygon.points = [Point32(random.random(), 2, 0)] * 4
    publisher.publish(corners)

rospy.init_node("finds")
publisher = rospy.Publisher("/waterhole/corners", PolygonStamped, queue_size=1)
rospy.Subscriber("/camera/rgb/image_raw", Image, found)
rospy.spin()
"""


def make(folder):
    build.hand_in_node(NODE, folder)
    for name in ("random", "signal", "json", "rospy", "cv2", "numpy", "rosbags"):
        (folder / f"{name}.py").write_text("raise SystemExit('not what the node means')")
    (folder / "course_lib").mkdir()
    (folder / "course_lib" / "__init__.py").write_text("raise SystemExit('an old copy')")
