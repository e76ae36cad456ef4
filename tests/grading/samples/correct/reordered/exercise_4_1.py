# %%
def locate_mug(mug, scene, match_count=100):
    kp1, des1 = find_keypoints(mug)
    kp2, des2 = find_keypoints(scene)
    best = match_keypoints(des1, des2)[:match_count]
    H, mask = fit(kp1, kp2, best)
    if H is None or mask.sum() < 10:
        return None
    return outline(mug, H)

# %%
def outline(mug, H):
    h, w = mug.shape[:2]
    corners = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]])
    corners = cv2.perspectiveTransform(corners.reshape(-1, 1, 2), H).reshape(4, 2)
    return corners if cv2.isContourConvex(corners) else None

# %%
def match_keypoints(query_descriptors, train_descriptors):
    # first try
    return cv2.BFMatcher().match(query_descriptors, train_descriptors)

# %%
import cv2

# %%
import numpy as np

# %%
def find_keypoints(image):
    return cv2.ORB_create(1000).detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)

# %%
def fit(kp1, kp2, best):
    if len(best) < 4:
        return None, None
    a = np.float32([kp1[m.queryIdx].pt for m in best])
    b = np.float32([kp2[m.trainIdx].pt for m in best])
    return cv2.findHomography(a, b, cv2.RANSAC, 5.0)

# %%
def load_images():
    mug = cv2.resize(images.load("ROS.png"), (400, 600))
    scene = cv2.resize(images.load("ROS2.png"), (600, 400))
    return mug, scene

# %%
from course_lib import drawing, images

# %%
# final version
def match_keypoints(query_descriptors, train_descriptors):
    if query_descriptors is None or train_descriptors is None:
        return []
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    return sorted(matcher.match(query_descriptors, train_descriptors), key=lambda m: m.distance)

# %%
def show_all():
    mug, scene = load_images()
    kp1, des1 = find_keypoints(mug)
    kp2, des2 = find_keypoints(scene)
    best = match_keypoints(des1, des2)[:40]
    drawing.show(drawing.draw_outline(scene, locate_mug(mug, scene)), alt="3")
    drawing.show(cv2.drawMatches(mug, kp1, scene, kp2, best, None, flags=2), alt="2")
    drawing.show(cv2.drawKeypoints(mug, kp1, None, color=(0, 0, 255)), alt="1")

# %%
show_all()

# %%
def find_keypoints(image):
    return cv2.ORB_create(1000).detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)

# %%
show_all()
