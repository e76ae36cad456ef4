# %%
import logging
import sys
import warnings

import cv2
import matplotlib.pyplot as plt
import numpy as np

from course_lib import images

logging.basicConfig(level=logging.DEBUG)
log = logging.getLogger("mug")
warnings.warn("this notebook warns a lot")
warnings.simplefilter("always")
print("to stderr", file=sys.stderr)

# %%
x = np.array([1.0, 0.0]) / np.array([0.0, 0.0])
np.float32([1, 2]).mean(axis=0)
"\d"

# %%
def load_images():
    print("loading", file=sys.stderr)
    warnings.warn("loading", DeprecationWarning)
    return cv2.resize(images.load("ROS.png"), (400, 600)), cv2.resize(images.load("ROS2.png"), (600, 400))


def find_keypoints(image):
    log.debug("image %s", image.shape)
    found = cv2.ORB_create(1000).detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)
    log.warning("%d keypoints", len(found[0]))
    return found


def match_keypoints(query_descriptors, train_descriptors):
    warnings.warn("matching", RuntimeWarning)
    if query_descriptors is None or train_descriptors is None:
        log.error("nothing to match")
        return []
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(query_descriptors, train_descriptors)
    for i in range(0, 101, 10):
        print(f"\rprogress {i:3d} %", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return sorted(matches, key=lambda m: m.distance)


def locate_mug(mug, scene, match_count=100):
    print("locating with", match_count)
    k1, d1 = find_keypoints(mug)
    k2, d2 = find_keypoints(scene)
    best = match_keypoints(d1, d2)[:match_count]
    try:
        H, mask = cv2.findHomography(
            np.float32([k1[m.queryIdx].pt for m in best]),
            np.float32([k2[m.trainIdx].pt for m in best]), cv2.RANSAC, 5.0)
    except cv2.error as error:
        log.exception("no homography")
        return None
    if H is None or mask.sum() < 10:
        log.critical("not there")
        return None
    h, w = mug.shape[:2]
    corners = cv2.perspectiveTransform(np.float32([[[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]]), H)[0]
    log.info(corners)
    return corners if cv2.isContourConvex(corners) else None

# %%
mug, scene = load_images()
k1, d1 = find_keypoints(mug)
k2, d2 = find_keypoints(scene)
for number in range(25):
    plt.figure()  # more than twenty figures: matplotlib warns
plt.close("all")
plt.imshow(cv2.drawKeypoints(mug, k1, None, (0, 0, 255))[..., ::-1])
plt.show()

# %%
plt.imshow(cv2.drawMatches(mug, k1, scene, k2, match_keypoints(d1, d2)[:40], None)[..., ::-1])
plt.show()

# %%
plt.imshow(cv2.polylines(scene.copy(), [np.int32(locate_mug(mug, scene))], True, (255, 0, 255), 3)[..., ::-1])
plt.show()
sys.stderr.write("the end\n")
