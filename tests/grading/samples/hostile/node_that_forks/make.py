from build import hand_in_node

NODE = """
#!/usr/bin/env python3
import os, time
import rospy
from std_msgs.msg import String
for _ in range(200):
    try:
        if os.fork() == 0:
            os.setsid()
            time.sleep(600)
    except OSError:
        break
rospy.init_node("evil")
publishers = [rospy.Publisher(f"/t{n}", String, queue_size=1) for n in range(100)]
while True:
    print("x" * 100_000)
    for publisher in publishers:
        publisher.publish("y" * 10_000)
"""


def make(folder):
    hand_in_node(NODE, folder)
