# %%
import os

import cv2
import numpy as np
from matplotlib import pyplot as plt

# %%
def _read(name, width, height):
    path = os.path.join("..", "images", name)
    data = np.fromfile(path, dtype=np.uint8)
    return cv2.resize(cv2.imdecode(data, cv2.IMREAD_COLOR), (width, height))

def load_images():
    return _read("ROS.png", 400, 600), _read("ROS2.png", 600, 400)

# %%
def find_keypoints(image):
    gray = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    keypoints, descriptors = cv2.ORB_create(1000).detectAndCompute(gray, None)
    if descriptors is None:
        descriptors = np.empty((0, 32), np.uint8)
    return keypoints, descriptors

# %%
def match_keypoints(query_descriptors, train_descriptors):
    if len(query_descriptors) == 0 or len(train_descriptors) == 0:
        return []
    bits = np.unpackbits(train_descriptors, axis=1)
    table = np.array([(bits != np.unpackbits(row)).sum(axis=1) for row in query_descriptors])
    result = []
    for i, j in enumerate(table.argmin(axis=1)):
        if table[:, j].argmin() == i:
            result.append(cv2.DMatch(int(i), int(j), float(table[i, j])))
    return sorted(result, key=lambda match: match.distance)

# %%
def is_sane(quad):
    area = cv2.contourArea(quad.astype(np.float32))
    return cv2.isContourConvex(quad.astype(np.float32)) and area > 900

def locate_mug(mug, scene, match_count=100):
    kps_mug, des_mug = find_keypoints(mug)
    kps_scene, des_scene = find_keypoints(scene)
    best = match_keypoints(des_mug, des_scene)[:match_count]
    if len(best) < 10:
        return None
    from_points = cv2.KeyPoint_convert(kps_mug, [m.queryIdx for m in best])
    to_points = cv2.KeyPoint_convert(kps_scene, [m.trainIdx for m in best])
    H, used = cv2.findHomography(from_points, to_points, cv2.USAC_MAGSAC, 5)
    if H is None:
        return None
    if np.count_nonzero(used) < 10:
        return None
    height, width = mug.shape[:2]
    outline = np.array([[[0, 0]], [[0, height - 1]], [[width - 1, height - 1]], [[width - 1, 0]]])
    quad = cv2.perspectiveTransform(outline.astype(np.float64), H)
    return quad[:, 0] if is_sane(quad) else None

# %%
def show(picture, title):
    plt.title(title)
    plt.axis("off")
    plt.imshow(picture[:, :, [2, 1, 0]])
    plt.show()

cup, shelf = load_images()
kps_cup, des_cup = find_keypoints(cup)
kps_shelf, des_shelf = find_keypoints(shelf)
show(cv2.drawKeypoints(cup, kps_cup, None, (255, 0, 0)), f"{len(kps_cup)} keypoints")
pairs = match_keypoints(des_cup, des_shelf)
show(cv2.drawMatches(cup, kps_cup, shelf, kps_shelf, pairs[:40], None), "matches")
where = locate_mug(cup, shelf).astype(int)
show(cv2.polylines(shelf.copy(), [where], True, (0, 255, 0), 2), "mug")
