#!/usr/bin/env python
# coding: utf-8

# # Exercise 4.1
#
# My notebook, exported.

# In[1]:


import cv2
import matplotlib.pyplot as plt
import numpy as np

get_ipython().run_line_magic('matplotlib', 'inline')


# In[2]:


def load_images():
    mug = cv2.imread("../images/ROS.png")
    scene = cv2.imread("../images/ROS2.png")
    return cv2.resize(mug, (400, 600)), cv2.resize(scene, (600, 400))


# In[3]:


def find_keypoints(image):
    orb = cv2.ORB_create(1000)
    return orb.detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)


# In[4]:


def match_keypoints(query_descriptors, train_descriptors):
    if query_descriptors is None or train_descriptors is None:
        return []
    bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    matches = list(bf.match(query_descriptors, train_descriptors))
    matches.sort(key=lambda match: match.distance)
    return matches


# ## Now the mug

# In[7]:


def locate_mug(mug, scene, match_count=100):
    keypoints1, descriptors1 = find_keypoints(mug)
    keypoints2, descriptors2 = find_keypoints(scene)
    matches = match_keypoints(descriptors1, descriptors2)[:match_count]
    if len(matches) < 4:
        return None
    points1 = np.float32([keypoints1[m.queryIdx].pt for m in matches])
    points2 = np.float32([keypoints2[m.trainIdx].pt for m in matches])
    homography, mask = cv2.findHomography(points1, points2, cv2.RANSAC, 5.0)
    if homography is None or mask.sum() < 11:
        return None
    height, width = mug.shape[:2]
    corners = np.float32([[0, 0], [0, height - 1], [width - 1, height - 1], [width - 1, 0]])
    outline = cv2.perspectiveTransform(corners.reshape(-1, 1, 2), homography)[:, 0]
    mirrored_or_tiny = cv2.contourArea(outline, oriented=True) > -400
    if mirrored_or_tiny or not cv2.isContourConvex(outline):
        return None
    return outline


# In[8]:


mug, scene = load_images()
keypoints1, descriptors1 = find_keypoints(mug)
keypoints2, descriptors2 = find_keypoints(scene)
plt.imshow(cv2.drawKeypoints(mug, keypoints1, None)[..., ::-1])
plt.show()


# In[9]:


matches = match_keypoints(descriptors1, descriptors2)
plt.figure(figsize=(10, 6))
plt.imshow(cv2.drawMatches(mug, keypoints1, scene, keypoints2, matches[:40], None)[..., ::-1])
plt.show()


# In[10]:


plt.imshow(cv2.polylines(scene.copy(), [locate_mug(mug, scene).astype(int)], True, (0, 0, 255), 3)[..., ::-1])
plt.show()
