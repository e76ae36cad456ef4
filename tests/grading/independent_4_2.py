"""Exercise 4.2 as different people would do it: a notebook's cells, and the files of `unit4/`."""

from __future__ import annotations

from pathlib import Path

import nbformat
from nbformat.v4 import new_code_cell, new_notebook

MANIFEST = """<?xml version="1.0"?>
<package format="2">
  <name>unit4</name> <version>1.0.0</version> <description>Waterhole</description>
  <maintainer email="me@example.org">me</maintainer> <license>BSD</license>
  <buildtool_depend>catkin</buildtool_depend>
  <exec_depend>rospy</exec_depend> <exec_depend>sensor_msgs</exec_depend>
  <exec_depend>geometry_msgs</exec_depend> <exec_depend>cv_bridge</exec_depend>
</package>
"""
CMAKE = """cmake_minimum_required(VERSION 3.0.2)
project(unit4)
find_package(catkin REQUIRED COMPONENTS rospy sensor_msgs cv_bridge)
catkin_package()
"""
CELLS = {
    "orb": [
        """import cv2, numpy as np
import matplotlib.pyplot as plt
from course_lib import camera
frames = [f.image for f in camera.open_camera("flight.bag")]""",
        """def crop_waterhole(frame):
    return frame[120:378, 198:434].copy()
template = crop_waterhole(frames[60])
cv2.imwrite("unit4/waterhole.png", template)
orb = cv2.ORB_create(nfeatures=1000)
kp, des = orb.detectAndCompute(cv2.cvtColor(template, cv2.COLOR_BGR2GRAY), None)
plt.imshow(cv2.drawKeypoints(template, kp, None, color=(0, 255, 0))[..., ::-1])
plt.show()""",
        """def locate_waterhole(template, frame, match_count):
    kp1, des1 = orb.detectAndCompute(cv2.cvtColor(template, cv2.COLOR_BGR2GRAY), None)
    kp2, des2 = orb.detectAndCompute(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY), None)
    if des1 is None or des2 is None:
        return None
    bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    good = sorted(bf.match(des1, des2), key=lambda m: m.distance)[:match_count]
    if len(good) < 4:
        return None
    src = np.float32([kp1[m.queryIdx].pt for m in good]).reshape(-1, 1, 2)
    dst = np.float32([kp2[m.trainIdx].pt for m in good]).reshape(-1, 1, 2)
    M, mask = cv2.findHomography(src, dst, cv2.RANSAC, 5.0)
    if M is None or mask.sum() < 10:
        return None
    h, w = template.shape[:2]
    pts = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]).reshape(-1, 1, 2)
    dst = cv2.perspectiveTransform(pts, M)
    if not cv2.isContourConvex(dst):
        return None
    return dst.reshape(4, 2)""",
        """def best_match_count(template, frames, candidates=range(4, 1001, 18)):
    best, best_found = None, -1
    for n in candidates:
        found = sum(locate_waterhole(template, f, n) is not None for f in frames)
        if found > best_found:
            best, best_found = n, found
    return best""",
        """where = locate_waterhole(template, frames[80], 100)
picture = cv2.polylines(frames[80].copy(), [np.int32(where)], True, (0, 0, 255), 3)
plt.imshow(picture[..., ::-1]); plt.show()
counts = [4, 22, 58, 112, 400]
found = [sum(locate_waterhole(template, f, n) is not None for f in frames[:90:30]) for n in counts]
plt.plot(counts, found); plt.xlabel("matches"); plt.ylabel("frames"); plt.show()""",
    ],
    "sift ratio": [
        """%matplotlib inline
import cv2
import numpy as np
from matplotlib import pyplot as plt
from pathlib import Path
from course_lib.camera import open_camera
flight = list(open_camera("flight.bag"))
X, Y, W, H = 190, 112, 250, 272""",
        """class Finder:
    def __init__(self):
        self.sift = cv2.SIFT_create()
        self.flann = cv2.FlannBasedMatcher({"algorithm": 1, "trees": 5}, {"checks": 64})

    def features(self, image):
        return self.sift.detectAndCompute(image, None)

    def find(self, template, frame, n):
        (ka, da), (kb, db) = self.features(template), self.features(frame)
        if da is None or db is None or len(db) < 2 or len(da) < 2:
            return None
        pairs = self.flann.knnMatch(da, db, k=2)
        good = [a for a, b in pairs if a.distance < 0.75 * b.distance]
        good.sort(key=lambda m: m.distance)
        good = good[:n]
        if len(good) < 4:
            return None
        src = np.array([ka[m.queryIdx].pt for m in good])
        dst = np.array([kb[m.trainIdx].pt for m in good])
        H, mask = cv2.findHomography(src, dst, cv2.USAC_MAGSAC, 4.0)
        if H is None or mask.sum() < 9:
            return None
        h, w = template.shape[:2]
        corners = np.array([[[0.0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]])
        out = cv2.perspectiveTransform(corners, H)[0]
        return out if cv2.isContourConvex(out.astype(np.float32)) else None

finder = Finder()
def crop_waterhole(frame): return frame[Y:Y+H, X:X+W]
def locate_waterhole(template, frame, match_count): return finder.find(template, frame, match_count)
def best_match_count(template, frames, candidates=range(4, 1001, 18)):
    rates = {c: np.mean([locate_waterhole(template, f, c) is not None for f in frames])
             for c in candidates}
    return max(rates, key=rates.get)""",
        """well = crop_waterhole(flight[60].image)
Path("unit4").mkdir(exist_ok=True)
cv2.imwrite("unit4/well_template.png", well)
some = [f.image for f in flight[10:90:20]]
fig, axes = plt.subplots(1, 3, figsize=(15, 4))
axes[0].imshow(cv2.drawKeypoints(well, finder.features(well)[0], None, flags=4)[..., ::-1])
axes[1].imshow(some[1][..., ::-1])
axes[1].plot(*locate_waterhole(well, some[1], 60)[[0, 1, 2, 3, 0]].T, "r", lw=2)
counts = (4, 8, 20, 60, 300)
share = [np.mean([locate_waterhole(well, f, c) is not None for f in some]) for c in counts]
axes[2].semilogx(counts, share, "o-")
plt.show()""",
    ],
    "akaze": [
        """import cv2
import numpy as np
import matplotlib.pyplot as plt
from IPython.display import Image, display
from course_lib import camera

def shown(picture):
    display(Image(data=cv2.imencode(".png", picture)[1].tobytes()))""",
        """def crop_waterhole(frame):
    left, top, right, bottom = 175, 100, 455, 395
    return np.ascontiguousarray(frame[top:bottom, left:right])

make = getattr(cv2, "AKAZE_create", None) or cv2.xfeatures2d.AKAZE_create
akaze = make()
bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)

def matched(template, frame):
    ka, da = akaze.detectAndCompute(template, None)
    kb, db = akaze.detectAndCompute(frame, None)
    if da is None or db is None or not len(da) or not len(db):
        return np.empty((0, 2)), np.empty((0, 2))
    found = sorted(bf.match(da, db), key=lambda m: m.distance)
    return (np.array([ka[m.queryIdx].pt for m in found]),
            np.array([kb[m.trainIdx].pt for m in found]))

def outline(shape, a, b):
    if len(a) < 8:
        return None
    H, inliers = cv2.findHomography(a, b, cv2.RANSAC, 5)
    if H is None or np.count_nonzero(inliers) < 10:
        return None
    h, w = shape[:2]
    box = np.float64([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]])
    corners = cv2.perspectiveTransform(box[None], H)[0]
    return corners if cv2.isContourConvex(np.float32(corners)) else None

def locate_waterhole(template, frame, match_count):
    a, b = matched(template, frame)
    return outline(template.shape, a[:match_count], b[:match_count])""",
        """def best_match_count(template, frames, candidates=range(4, 1001, 18)):
    candidates = list(candidates)
    # Matching takes long, and is the same for all candidates.
    pairs = [matched(template, frame) for frame in frames]
    found = [sum(outline(template.shape, a[:n], b[:n]) is not None for a, b in pairs)
             for n in candidates]
    return int(np.array(candidates)[np.argmax(found)])""",
        """with camera.open_camera("flight.bag") as source:
    views = [each.image for number, each in zip(range(101), source) if number % 20 == 0]
template = crop_waterhole(views[3])
cv2.imwrite("unit4/waterhole.png", template)
shown(cv2.drawKeypoints(template, akaze.detect(template), None, (0, 0, 255)))
corners = locate_waterhole(template, views[4], 100)
shown(cv2.polylines(views[4].copy(), [corners.astype(int)], True, (255, 0, 0), 2))
counts = [4, 12, 60, 300]
hits = [sum(locate_waterhole(template, v, n) is not None for v in views) for n in counts]
plt.bar(range(4), hits); plt.xticks(range(4), counts); plt.show()""",
    ],
}
TAKES = {
    "callback": """#!/usr/bin/env python3
import os

import cv2
import rospy
from cv_bridge import CvBridge
from sensor_msgs.msg import Image

FILE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "frame.png")
saved = False


def callback(msg):
    global saved
    if not saved:
        cv2.imwrite(FILE, CvBridge().imgmsg_to_cv2(msg, desired_encoding="bgr8"))
        saved = True
        rospy.signal_shutdown("saved")


rospy.init_node("take_picture")
rospy.Subscriber("/camera/rgb/image_raw", Image, callback)
rospy.spin()
""",
    "waits": """#!/usr/bin/env python
import sys
import cv2, rospy
import numpy as np
from sensor_msgs.msg import Image
rospy.init_node('one_picture')
rospy.sleep(1.0)
m = rospy.wait_for_message('image', Image, timeout=20)
a = np.frombuffer(m.data, np.uint8).reshape(m.height, m.step)[:, :m.width * 3]
a = a.reshape(m.height, m.width, 3)
if m.encoding == 'rgb8':
    a = a[:, :, ::-1]
ok = cv2.imwrite(rospy.get_param('~file', 'picture.jpg'), a)
sys.exit(0 if ok else 1)
""",
}
FINDS = {
    "functions": """#!/usr/bin/env python3
import os
import cv2
import numpy as np
import rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import Point32, PolygonStamped
from sensor_msgs.msg import Image

bridge = CvBridge()
here = os.path.dirname(os.path.abspath(__file__))
template = cv2.imread(os.path.join(here, "../waterhole.png"))
orb = cv2.ORB_create(1000)
kp1, des1 = orb.detectAndCompute(template, None)
bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)


def callback(msg):
    frame = bridge.imgmsg_to_cv2(msg, "bgr8")
    kp2, des2 = orb.detectAndCompute(frame, None)
    good = sorted(bf.match(des1, des2), key=lambda m: m.distance)[:100]
    a = np.float32([kp1[m.queryIdx].pt for m in good])
    b = np.float32([kp2[m.trainIdx].pt for m in good])
    M, mask = cv2.findHomography(a, b, cv2.RANSAC, 5.0)
    if M is not None and mask.sum() >= 10:
        h, w = template.shape[:2]
        pts = np.float32([[[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]])
        pts = cv2.perspectiveTransform(pts, M)
        if cv2.isContourConvex(pts):
            poly = PolygonStamped()
            poly.header.stamp = msg.header.stamp
            poly.polygon.points = [Point32(float(x), float(y), 0.0) for x, y in pts[0]]
            corners_pub.publish(poly)
            cv2.polylines(frame, [np.int32(pts)], True, (0, 255, 0), 2)
    image_pub.publish(bridge.cv2_to_imgmsg(frame, "bgr8"))


rospy.init_node("find_waterhole")
image_pub = rospy.Publisher("/waterhole/image", Image, queue_size=10)
corners_pub = rospy.Publisher("/waterhole/corners", PolygonStamped, queue_size=10)
rospy.Subscriber("/camera/rgb/image_raw", Image, callback)
rospy.spin()
""",
    "class": '''#!/usr/bin/env python3
"""Finds the waterhole with SIFT."""
import cv2
import numpy as np
import rospy
from cv_bridge import CvBridge, CvBridgeError
from geometry_msgs.msg import Point32, Polygon, PolygonStamped
from sensor_msgs.msg import Image


class WaterholeFinder(object):
    def __init__(self):
        self.sift = cv2.SIFT_create()
        self.template = cv2.imread(rospy.get_param("~template"))
        if self.template is None:
            raise IOError("no template")
        self.k, self.d = self.sift.detectAndCompute(self.template, None)
        self.count = rospy.get_param("~count")
        self.bridge = CvBridge()
        self.out = rospy.Publisher("image_out", Image, queue_size=1)
        self.corners = rospy.Publisher("corners", PolygonStamped, queue_size=1)
        self.sub = rospy.Subscriber("frames", Image, self.on_image, queue_size=1, buff_size=1 << 24)

    def locate(self, frame):
        k, d = self.sift.detectAndCompute(frame, None)
        if d is None or len(d) < 2:
            return None
        pairs = cv2.BFMatcher().knnMatch(self.d, d, k=2)
        good = sorted((p for p, q in pairs if p.distance < 0.8 * q.distance),
                      key=lambda m: m.distance)[:self.count]
        if len(good) < 10:
            return None
        H, mask = cv2.findHomography(np.float32([self.k[m.queryIdx].pt for m in good]),
                                     np.float32([k[m.trainIdx].pt for m in good]), cv2.RANSAC, 5)
        if H is None or mask.sum() < 10:
            return None
        h, w = self.template.shape[:2]
        box = np.float32([[0, 0], [0, h], [w, h], [w, 0]]).reshape(-1, 1, 2)
        corners = cv2.perspectiveTransform(box, H).reshape(4, 2)
        return corners if cv2.isContourConvex(corners) else None

    def on_image(self, message):
        try:
            frame = self.bridge.imgmsg_to_cv2(message, "bgr8")
        except CvBridgeError as error:
            rospy.logerr(error)
            return
        corners = self.locate(frame)
        polygon = Polygon()
        if corners is not None:
            polygon.points = [Point32(x=x, y=y) for x, y in corners]
            cv2.drawContours(frame, [corners.astype(np.int32)], -1, (255, 0, 255), 4)
        self.corners.publish(PolygonStamped(header=message.header, polygon=polygon))
        out = self.bridge.cv2_to_imgmsg(frame, encoding="bgr8")
        out.header = message.header
        self.out.publish(out)


if __name__ == "__main__":
    rospy.init_node("finder")
    WaterholeFinder()
    rospy.spin()
''',
    "loop": """#!/usr/bin/env python3
from pathlib import Path

import cv2
import numpy as np
import rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import Point32, PolygonStamped
from sensor_msgs.msg import Image

latest = []


def locate(detector, keypoints, descriptors, shape, frame):
    found, described = detector.detectAndCompute(frame, None)
    if described is None:
        return None
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, True).match(descriptors, described)
    best = sorted(matches, key=lambda m: m.distance)[:80]
    if len(best) < 4:
        return None
    a = np.array([keypoints[m.queryIdx].pt for m in best])
    b = np.array([found[m.trainIdx].pt for m in best])
    H, inliers = cv2.findHomography(a, b, cv2.RANSAC, 5)
    if H is None or inliers.sum() < 10:
        return None
    h, w = shape
    corners = np.array([[0, 0, 1], [0, h - 1, 1], [w - 1, h - 1, 1], [w - 1, 0, 1]]) @ H.T
    corners = np.float32(corners[:, :2] / corners[:, 2:])
    return corners if cv2.isContourConvex(corners) else None


def main():
    rospy.init_node("waterhole")
    bridge = CvBridge()
    picture = cv2.imread(str(Path(__file__).resolve().parents[1] / "waterhole.png"))
    make = getattr(cv2, "AKAZE_create", None) or cv2.xfeatures2d.AKAZE_create
    detector = make()
    keypoints, descriptors = detector.detectAndCompute(picture, None)
    outlined = rospy.Publisher("waterhole/image", Image, queue_size=1)
    corners_out = rospy.Publisher("waterhole/corners", PolygonStamped, queue_size=1)
    rospy.Subscriber("camera/rgb/image_raw", Image, latest.append)
    rate = rospy.Rate(50)
    while not rospy.is_shutdown():
        while latest:
            message = latest.pop(0)
            frame = bridge.imgmsg_to_cv2(message, "bgr8")
            corners = locate(detector, keypoints, descriptors, picture.shape[:2], frame)
            if corners is not None:
                polygon = PolygonStamped(header=message.header)
                polygon.polygon.points = [Point32(*map(float, (x, y, 0))) for x, y in corners]
                corners_out.publish(polygon)
                for p, q in zip(corners, np.roll(corners, 1, axis=0)):
                    cv2.line(frame, tuple(map(int, p)), tuple(map(int, q)), (0, 255, 255), 3)
            outlined.publish(bridge.cv2_to_imgmsg(frame, "bgr8"))
        rate.sleep()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
""",
}
PLAIN = """<launch>
  <node pkg="unit4" type="{node}.py" name="{node}" output="screen"/>
</launch>
"""
REMAPPED = """<launch>
  <arg name="camera" default="/camera/rgb/image_raw"/>
  <arg name="count" default="70"/>
  <group ns="waterhole">
    <!-- Not "image": rospy would remap /waterhole/image, too, and publish to the camera. -->
    <remap from="frames" to="$(arg camera)"/>
    <node pkg="unit4" type="exercise4_2_2.py" name="finder" output="screen">
      <remap from="image_out" to="/waterhole/image"/>
      <param name="template" type="str" value="$(find unit4)/well_template.png"/>
      <param name="count" value="$(arg count)"/>
    </node>
  </group>
</launch>
"""
REMAPPED_FIRST = """<launch>
  <node pkg="unit4" type="exercise4_2_1.py" name="one" output="screen"
        args="image:=/camera/rgb/image_raw _file:=picture.png" required="true"/>
</launch>
"""
# First node, second node, first and second launch file.
PACKAGES = {
    "orb": ("callback", "functions", PLAIN, PLAIN),
    "sift ratio": ("waits", "class", REMAPPED_FIRST, REMAPPED),
    "akaze": ("callback", "loop", PLAIN, PLAIN),
}


def handed_in(style: str, into: Path) -> Path:
    """Write a submission of one of the styles to a folder."""
    cells = [new_code_cell(source) for source in CELLS[style]]
    into.mkdir(parents=True, exist_ok=True)
    nbformat.write(new_notebook(cells=cells), into / "exercise_4_2.ipynb")
    takes, finds, *launch = PACKAGES[style]
    files = {
        "package.xml": MANIFEST,
        "CMakeLists.txt": CMAKE,
        "src/exercise4_2_1.py": TAKES[takes],
        "src/exercise4_2_2.py": FINDS[finds],
    }
    for number, text in enumerate(launch, 1):
        node = f"exercise4_2_{number}"
        files[f"launch/{node}.launch"] = text.replace("{node}", node)
    for name, text in files.items():
        path = into / "unit4" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755 if name.endswith(".py") else 0o644)
    return into
