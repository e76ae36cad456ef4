# A right submission, as short as it can be: what surrounds a hostile cell.
# %%
import cv2
import numpy as np
from course_lib import images
from IPython.display import Image, display

# %%
def load_images():
    return (
        cv2.resize(images.load("ROS.png"), (400, 600), interpolation=cv2.INTER_AREA),
        cv2.resize(images.load("ROS2.png"), (600, 400), interpolation=cv2.INTER_AREA),
    )

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
def locate_mug(mug, scene, match_count=100):
    (here, query), (there, train) = find_keypoints(mug), find_keypoints(scene)
    best = match_keypoints(query, train)[:match_count]
    if len(best) < 4:
        return None
    H, mask = cv2.findHomography(
        np.float32([here[m.queryIdx].pt for m in best]),
        np.float32([there[m.trainIdx].pt for m in best]),
        cv2.RANSAC,
        5.0,
    )
    if H is None or mask.sum() < 10:
        return None
    h, w = mug.shape[:2]
    corners = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]])
    corners = cv2.perspectiveTransform(corners.reshape(-1, 1, 2), H).reshape(4, 2)
    good = cv2.isContourConvex(corners) and -cv2.contourArea(corners, oriented=True) > 400
    return corners if good else None

# %%
def show(picture):
    display(Image(cv2.imencode(".png", picture)[1].tobytes()))

mug, scene = load_images()
(kp_mug, des_mug), (kp_scene, des_scene) = find_keypoints(mug), find_keypoints(scene)
show(cv2.drawKeypoints(mug, kp_mug, None, color=(0, 160, 0)))
best = match_keypoints(des_mug, des_scene)[:40]
show(cv2.drawMatches(mug, kp_mug, scene, kp_scene, best, None, flags=2))
show(cv2.polylines(scene.copy(), [np.int32(locate_mug(mug, scene))], True, (0, 200, 0), 3))
