# %%
import cv2
import numpy as np
import matplotlib.pyplot as plt

# %%
def load_images():
    mug = cv2.imread("../images/ROS.png")
    scene = cv2.imread("../images/ROS2.png")
    mug = cv2.resize(mug, (400, 600))
    scene = cv2.resize(scene, (600, 400))
    return mug, scene

# %%
def find_keypoints(image):
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    orb = cv2.ORB_create(nfeatures=1500)
    # None: no mask
    return orb.detectAndCompute(gray, None)

# %%
def match_keypoints(query_descriptors, train_descriptors):
    bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    matches = bf.match(query_descriptors, train_descriptors)
    return sorted(matches, key=lambda x: x.distance)

# %%
def locate_mug(mug, scene, match_count=100):
    kp1, des1 = find_keypoints(mug)
    kp2, des2 = find_keypoints(scene)
    if des1 is None or des2 is None:
        return None
    good = match_keypoints(des1, des2)[:match_count]
    if len(good) < 10:
        return None
    src = np.float32([kp1[m.queryIdx].pt for m in good]).reshape(-1, 1, 2)
    dst = np.float32([kp2[m.trainIdx].pt for m in good]).reshape(-1, 1, 2)
    M, mask = cv2.findHomography(src, dst, cv2.RANSAC, 5.0)
    if M is None or mask.sum() < 12:
        return None
    h, w = mug.shape[:2]
    pts = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]).reshape(-1, 1, 2)
    corners = cv2.perspectiveTransform(pts, M).reshape(4, 2)
    # the right way round and of some size: then the area is negative and large
    if not cv2.isContourConvex(corners) or cv2.contourArea(corners, oriented=True) > -400:
        return None
    return corners

# %%
mug, scene = load_images()
kp, des = find_keypoints(mug)
plt.figure(figsize=(8, 8))
plt.imshow(cv2.cvtColor(cv2.drawKeypoints(mug, kp, None, color=(0, 255, 0)), cv2.COLOR_BGR2RGB))
plt.show()

# %%
kp2, des2 = find_keypoints(scene)
m = match_keypoints(des, des2)
plt.imshow(cv2.drawMatches(mug, kp, scene, kp2, m[:30], None, flags=2)[:, :, ::-1])
plt.show()

# %%
corners = locate_mug(mug, scene)
out = scene.copy()
cv2.polylines(out, [np.int32(corners)], True, (0, 0, 255), 3)
plt.imshow(cv2.cvtColor(out, cv2.COLOR_BGR2RGB))
plt.show()
