# %%
import cv2
import numpy as np

from course_lib import drawing, images

# %%
def load_images():
    mug = cv2.resize(images.load("ROS.png"), (400, 600), interpolation=cv2.INTER_AREA)
    scene = cv2.resize(images.load("ROS2.png"), (600, 400), interpolation=cv2.INTER_AREA)
    return mug, scene

# %%
def find_keypoints(image):
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    return cv2.ORB_create(1000).detectAndCompute(gray, None)

# %%
def match_keypoints(query_descriptors, train_descriptors):
    if query_descriptors is None or train_descriptors is None:
        return []
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    return sorted(matcher.match(query_descriptors, train_descriptors), key=lambda m: m.distance)

# %%
def fit_homography(mug, scene, match_count):
    keypoints_mug, descriptors_mug = find_keypoints(mug)
    keypoints_scene, descriptors_scene = find_keypoints(scene)
    best = match_keypoints(descriptors_mug, descriptors_scene)[:match_count]
    if len(best) < 4:
        return None, 0
    points_mug = np.float32([keypoints_mug[m.queryIdx].pt for m in best])
    points_scene = np.float32([keypoints_scene[m.trainIdx].pt for m in best])
    H, mask = cv2.findHomography(points_mug, points_scene, cv2.RANSAC, 5.0)
    return H, 0 if H is None else int(mask.sum())

# %%
def locate_mug(mug, scene, match_count=100):
    H, inlier_count = fit_homography(mug, scene, match_count)
    if H is None or inlier_count < 10:
        return None
    h, w = mug.shape[:2]
    corners_mug = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]])
    corners = cv2.perspectiveTransform(corners_mug.reshape(-1, 1, 2), H).reshape(4, 2)
    area = -cv2.contourArea(corners, oriented=True)  # negative when it is mirrored
    return corners if cv2.isContourConvex(corners) and area > 400 else None

# %%
mug, scene = load_images()
keypoints, descriptors = find_keypoints(mug)
keypoint_picture = cv2.drawKeypoints(mug, keypoints, None, color=(0, 160, 0))
drawing.show(keypoint_picture, alt="The mug with a circle on each keypoint.")

# %%
keypoints_scene, descriptors_scene = find_keypoints(scene)
shown = match_keypoints(descriptors, descriptors_scene)[:40]
match_picture = cv2.drawMatches(mug, keypoints, scene, keypoints_scene, shown, None, flags=2)
drawing.show(match_picture, alt="A line from the mug to the scene for each match.")

# %%
corners = locate_mug(mug, scene)
print("not found" if corners is None else corners)

# %%
outline_picture = scene.copy()
if corners is not None:
    cv2.polylines(outline_picture, [np.int32(np.round(corners))], True, (0, 200, 0), 3)
drawing.show(outline_picture, alt="The shelf with an outline around the mug.")

# %%
peppers = cv2.resize(images.load("peppers.png"), (600, 400))
print("no mug:", locate_mug(mug, peppers))
