# %%
import cv2
import numpy as np
import matplotlib.pyplot as plt

from course_lib import images

FLANN_INDEX_LSH = 6
index_params = dict(algorithm=FLANN_INDEX_LSH, table_number=12, key_size=20, multi_probe_level=2)
search_params = dict(checks=100)

# %%
def load_images():
    img_mug = cv2.imread(str(images.path("ROS.png")))
    img_scene = cv2.imread(str(images.path("ROS2.png")))
    img_mug = cv2.resize(img_mug, (400, 600))
    img_scene = cv2.resize(img_scene, (600, 400))
    return img_mug, img_scene

# %%
def find_keypoints(image):
    orb = cv2.ORB_create(nfeatures=3000, scoreType=cv2.ORB_FAST_SCORE)
    return orb.detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)

# %%
def match_keypoints(query_descriptors, train_descriptors):
    if query_descriptors is None or train_descriptors is None:
        return []
    if len(query_descriptors) < 2 or len(train_descriptors) < 2:
        return []
    flann = cv2.FlannBasedMatcher(index_params, search_params)
    pairs = flann.knnMatch(query_descriptors, train_descriptors, k=2)
    # LSH may return fewer than two neighbours
    good = [p[0] for p in pairs if len(p) == 2 and p[0].distance < 0.8 * p[1].distance]
    return sorted(good, key=lambda m: m.distance)

# %%
def locate_mug(mug, scene, match_count=100):
    kp1, des1 = find_keypoints(mug)
    kp2, des2 = find_keypoints(scene)
    good = match_keypoints(des1, des2)[:match_count]
    if len(good) < 10:
        return None
    src_pts = np.float32([kp1[m.queryIdx].pt for m in good]).reshape(-1, 1, 2)
    dst_pts = np.float32([kp2[m.trainIdx].pt for m in good]).reshape(-1, 1, 2)
    M, mask = cv2.findHomography(src_pts, dst_pts, cv2.RANSAC, 5.0)
    if M is None or np.count_nonzero(mask) < 10:
        return None
    h, w, c = mug.shape
    pts = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]).reshape(-1, 1, 2)
    dst = cv2.perspectiveTransform(pts, M)
    if not cv2.isContourConvex(dst):
        return None
    return dst[:, 0, :]

# %%
mug, scene = load_images()
kp_m, des_m = find_keypoints(mug)
kp_s, des_s = find_keypoints(scene)
matches = match_keypoints(des_m, des_s)

plt.figure(figsize=(6, 9))
plt.imshow(cv2.cvtColor(cv2.drawKeypoints(mug, kp_m, None, (0, 255, 0)), cv2.COLOR_BGR2RGB))
plt.show()

# %%
plt.figure(figsize=(12, 7))
drawn = cv2.drawMatches(mug, kp_m, scene, kp_s, matches[:50], None, matchColor=(0, 255, 0), flags=2)
plt.imshow(cv2.cvtColor(drawn, cv2.COLOR_BGR2RGB))
plt.show()

# %%
result = locate_mug(mug, scene)
out = cv2.polylines(scene.copy(), [np.int32(result)], True, 255, 3, cv2.LINE_AA)
plt.figure(figsize=(9, 6))
plt.imshow(cv2.cvtColor(out, cv2.COLOR_BGR2RGB))
plt.show()
