# %%
"""The student's notebook of the graders' comparison: a mug is found on a shelf."""

import cv2
import numpy as np


# %%
def load_images():
    return cv2.imread("mug.png"), cv2.imread("shelf.png")


# %%
def find_keypoints(image):
    grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    return cv2.ORB_create(1000).detectAndCompute(grey, None)


# %%
def match_keypoints(query_descriptors, train_descriptors):
    if query_descriptors is None or train_descriptors is None:
        return []
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    return sorted(matcher.match(query_descriptors, train_descriptors), key=lambda m: m.distance)


# %%
def locate_mug(mug, scene, match_count=100):
    keypoints_mug, descriptors_mug = find_keypoints(mug)
    keypoints_scene, descriptors_scene = find_keypoints(scene)
    best = match_keypoints(descriptors_mug, descriptors_scene)[:match_count]
    if len(best) < 4:
        return None
    points_mug = np.float32([keypoints_mug[m.queryIdx].pt for m in best])
    points_scene = np.float32([keypoints_scene[m.trainIdx].pt for m in best])
    H, mask = cv2.findHomography(points_mug, points_scene, cv2.RANSAC, 5.0)
    if H is None or mask.sum() < 10:
        return None
    h, w = mug.shape[:2]
    corners_mug = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]])
    return cv2.perspectiveTransform(corners_mug.reshape(-1, 1, 2), H).reshape(4, 2)


# %%
corners = locate_mug(*load_images())
print("found" if corners is not None else "not found")
