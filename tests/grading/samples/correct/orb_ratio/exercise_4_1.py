# %% [markdown]
# ## My own settings

# %%
import cv2
import numpy as np

from course_lib import check, drawing, images, matching

# %%
N_FEATURES = 2500
RATIO = 0.82

# %%
def to_gray(image):
    if image.ndim == 2:
        return image
    return cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)

# %%
def shrink(image, width, height):
    return cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA)

# %%
def load_images():
    return shrink(images.load("ROS.png"), 400, 600), shrink(images.load("ROS2.png"), 600, 400)

# %%
check("4.1", "load_images")

# %%
def find_keypoints(image):
    return cv2.ORB_create(N_FEATURES).detectAndCompute(to_gray(image), None)

# %%
check("4.1", "find_keypoints")

# %%
def how_good(pair):
    best, second = pair
    return best.distance / max(second.distance, 1)

# %%
def match_keypoints(query_descriptors, train_descriptors):
    if query_descriptors is None or train_descriptors is None or len(train_descriptors) < 2:
        return []
    pairs = cv2.BFMatcher(cv2.NORM_HAMMING).knnMatch(query_descriptors, train_descriptors, k=2)
    pairs = sorted((pair for pair in pairs if len(pair) == 2), key=how_good)
    return [pair[0] for pair in pairs if how_good(pair) < RATIO]

# %%
def as_points(keypoints, indices):
    return np.float32([keypoints[i].pt for i in indices])

# %%
def corners_of(image):
    h, w = image.shape[:2]
    return np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]])[:, None]

# %%
def is_an_outline(corners):
    return cv2.isContourConvex(corners) and -cv2.contourArea(corners, oriented=True) > 500

# %%
def locate_mug(mug, scene, match_count=100):
    (kp_mug, des_mug), (kp_scene, des_scene) = find_keypoints(mug), find_keypoints(scene)
    good = match_keypoints(des_mug, des_scene)[:match_count]
    if len(good) < 10:
        return None
    a = as_points(kp_mug, [m.queryIdx for m in good])
    b = as_points(kp_scene, [m.trainIdx for m in good])
    H, mask = cv2.findHomography(a, b, cv2.RANSAC, 5)
    if H is None or mask.sum() < 10:
        return None
    corners = cv2.perspectiveTransform(corners_of(mug), H)
    return corners[:, 0] if is_an_outline(corners) else None

# %%
mug, scene = load_images()
kp_mug, des_mug = find_keypoints(mug)
kp_scene, des_scene = find_keypoints(scene)
drawing.show(drawing.draw_keypoints(mug, kp_mug), alt="keypoints", width=400)

# %%
best = match_keypoints(des_mug, des_scene)[:40]
drawing.show(drawing.draw_matches(mug, kp_mug, scene, kp_scene, best), alt="matches", width=760)

# %%
drawing.show(drawing.draw_outline(scene, locate_mug(mug, scene)), alt="outline", width=600)
