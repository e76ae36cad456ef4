# %%
import operator
import pathlib

import cv2
import numpy as np
from IPython.display import Image, display

# %%
PICTURES = pathlib.Path("..") / "images"

def load_images():
    sizes = {"ROS.png": (400, 600), "ROS2.png": (600, 400)}
    loaded = []
    for name, size in sizes.items():
        picture = cv2.imread(str(PICTURES / name), cv2.IMREAD_COLOR)
        if picture is None:
            raise FileNotFoundError(name)
        loaded.append(cv2.resize(picture, size, interpolation=cv2.INTER_AREA))
    return tuple(loaded)

# %%
sift = cv2.SIFT_create(contrastThreshold=0.03)

def find_keypoints(image):
    detector = cv2.ORB_create(2000, fastThreshold=10)
    keypoints = detector.detect(image)
    keypoints, descriptors = detector.compute(image, keypoints)
    return keypoints, descriptors

# %%
def match_keypoints(query_descriptors, train_descriptors):
    forth = cv2.BFMatcher(cv2.NORM_HAMMING).match(query_descriptors, train_descriptors)
    back = cv2.BFMatcher(cv2.NORM_HAMMING).match(train_descriptors, query_descriptors)
    partner = {b.queryIdx: b.trainIdx for b in back}
    mutual = [f for f in forth if partner.get(f.trainIdx) == f.queryIdx]
    mutual.sort(key=operator.attrgetter("distance"))
    return mutual

# %%
def locate_mug(mug, scene, match_count=100):
    points_mug, desc_mug = sift.detectAndCompute(mug, None)
    points_scene, desc_scene = sift.detectAndCompute(scene, None)
    if desc_scene is None or len(desc_scene) < 2:
        return None
    kept = []
    for first, second in cv2.BFMatcher().knnMatch(desc_mug, desc_scene, k=2):
        if first.distance < 0.75 * second.distance:
            kept.append(first)
    kept = sorted(kept, key=lambda match: match.distance)[:match_count]
    if len(kept) < 8:
        return None
    a = np.array([points_mug[match.queryIdx].pt for match in kept], dtype=np.float32)
    b = np.array([points_scene[match.trainIdx].pt for match in kept], dtype=np.float32)
    homography, inliers = cv2.findHomography(a, b, method=cv2.USAC_MAGSAC, ransacReprojThreshold=3)
    if homography is None or inliers.ravel().sum() < 8:
        return None
    height, width, _ = mug.shape
    frame = np.array([(0, 0), (0, height - 1), (width - 1, height - 1), (width - 1, 0)], float)
    seen = cv2.perspectiveTransform(frame[None], homography)[0].astype(np.float32)
    if not cv2.isContourConvex(seen) or cv2.contourArea(seen, oriented=True) > -400:
        return None
    return seen

# %%
template, shelf = load_images()
found_points, _ = find_keypoints(template)
canvas = cv2.drawKeypoints(template, found_points, outImage=None, flags=4)
display(Image(data=cv2.imencode(".png", canvas)[1].tobytes()))

# %%
shelf_points, shelf_descriptors = find_keypoints(shelf)
_, template_descriptors = find_keypoints(template)
mutual = match_keypoints(template_descriptors, shelf_descriptors)
canvas = cv2.drawMatches(template, found_points, shelf, shelf_points, mutual[:60], None)
display(Image(data=cv2.imencode(".jpg", canvas)[1].tobytes()))

# %%
where = locate_mug(template, shelf)
picture = shelf.copy()
if where is not None:
    for start, end in zip(where, np.roll(where, -1, axis=0)):
        cv2.line(picture, tuple(map(int, start)), tuple(map(int, end)), (0, 255, 255), 4)
display(Image(data=cv2.imencode(".png", picture)[1].tobytes()))
