import nbformat
from build import notebook

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
    nbformat.write(notebook("# %%\ndef crop_waterhole(frame):\n    return frame"), folder / "exercise_4_2.ipynb")
    (folder / "unit4" / "src").mkdir(parents=True)
    (folder / "unit4" / "package.xml").write_text("<package/>")
    node = folder / "unit4" / "src" / "exercise4_2_2.py"
    node.write_text(NODE)
    node.chmod(0o755)
