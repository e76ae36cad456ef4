# %%
import cv2
import numpy as np

from course_lib import check, drawing, images

# %%
def load_images():
    mug = cv2.resize(images.load("ROS.png"), (400, 600))
    scene = cv2.resize(images.load("ROS2.png"), (600, 400))
    return mug, scene

# %%
def find_keypoints(image):
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    return cv2.ORB_create(1000).detectAndCompute(gray, None)

# %%
mug, scene = load_images()
keypoints, descriptors = find_keypoints(mug)
drawing.show(cv2.drawKeypoints(mug, keypoints, None, color=(0, 160, 0)), alt="keypoints")

# %%
def match_keypoints(query_descriptors, train_descriptors):
    raise NotImplementedError("step 3: BFMatcher with crossCheck=True, sorted by distance")

# %%
with check.when_done():
    matches = match_keypoints(descriptors, descriptors)

# %%
def locate_mug(mug, scene, match_count=100):
    raise NotImplementedError("step 4: send the corners through H; None unless it is believable")

# %%
check("4.1")
