# %% [markdown]
# # Exercise 4.1
# I use AKAZE here: its scale space keeps edges, and its descriptors are binary as well.

# %%
import cv2
import numpy as np

from course_lib import drawing, images

AKAZE = getattr(cv2, "AKAZE_create", None) or cv2.xfeatures2d.AKAZE_create

# %%
def load_images():
    mug = images.resize(images.load("ROS.png"), 400, 600)
    scene = images.resize(images.load("ROS2.png"), 600, 400)
    return mug, scene


def find_keypoints(image):
    return AKAZE(threshold=0.0004).detectAndCompute(image, None)


def match_keypoints(query_descriptors, train_descriptors):
    if query_descriptors is None or train_descriptors is None:
        return []
    if len(query_descriptors) == 0 or len(train_descriptors) == 0:
        return []
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(
        query_descriptors, train_descriptors
    )
    return sorted(matches, key=lambda m: m.distance)

# %%
def locate_mug(mug, scene, match_count=100):
    kp1, des1 = find_keypoints(mug)
    kp2, des2 = find_keypoints(scene)
    matches = match_keypoints(des1, des2)[:match_count]
    if len(matches) < 8:
        return None
    src = np.array([kp1[m.queryIdx].pt for m in matches], np.float32)
    dst = np.array([kp2[m.trainIdx].pt for m in matches], np.float32)
    H, mask = cv2.findHomography(src, dst, cv2.USAC_MAGSAC, 5.0, maxIters=5000)
    if H is None or mask.sum() < 10:
        return None
    h, w = mug.shape[:2]
    corners = cv2.perspectiveTransform(
        np.array([[[0, 0]], [[0, h - 1]], [[w - 1, h - 1]], [[w - 1, 0]]], np.float32), H
    )
    if not cv2.isContourConvex(corners) or cv2.contourArea(corners) < 500:
        return None
    return corners.reshape(-1, 2)

# %%
mug, scene = load_images()
kp_mug, des_mug = find_keypoints(mug)
kp_scene, des_scene = find_keypoints(scene)
print(len(kp_mug), len(kp_scene))
drawing.show(
    cv2.drawKeypoints(mug, kp_mug, None, color=(0, 0, 255)), alt="mug with keypoints"
)

# %%
matches = match_keypoints(des_mug, des_scene)
picture = cv2.drawMatches(mug, kp_mug, scene, kp_scene, matches[:40], None, flags=2)
drawing.show(picture, alt="matches")

# %%
# AKAZE finds few points on the small mug: all matches help, not only the best hundred.
corners = locate_mug(mug, scene, 400)
drawing.show(drawing.draw_outline(scene, corners), alt="the mug")
