# %%
import cv2, numpy as np, matplotlib.pyplot as plt
from concurrent.futures import ThreadPoolExecutor
from course_lib import drawing, images
# %%
def load_images():
    return images.resize(images.load("ROS.png"), 400, 600), images.resize(images.load("ROS2.png"), 600, 400)

def find_keypoints(image):
    kp, d = _orb(image)
    order = np.argsort([-p.response for p in kp])
    return [cv2.KeyPoint(x=kp[i].pt[0], y=kp[i].pt[1], size=kp[i].size, angle=kp[i].angle) for i in order], np.ascontiguousarray(d[order]) if d is not None else None

def _orb(image):
    return cv2.ORB_create(1000).detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)

def match_keypoints(q, t):
    if q is None or t is None: return []
    if not len(q) or not len(t): return ()
    D = np.unpackbits(q[:, None] ^ t[None], axis=2).sum(2)
    i = np.arange(len(q)); j = D.argmin(1)
    keep = D.argmin(0)[j] == i
    return tuple(sorted((cv2.DMatch(int(a), int(b), float(D[a, b])) for a, b in zip(i[keep], j[keep])), key=lambda m: (m.distance, m.trainIdx)))

def locate_mug(mug, scene, match_count=100):
    with ThreadPoolExecutor(2) as pool:
        (ka, da), (kb, db) = pool.map(find_keypoints, [mug, scene])
    m = match_keypoints(da, db)[:match_count]
    if len(m) < 10: return None
    H, mask = cv2.findHomography(np.float32([ka[i.queryIdx].pt for i in m]), np.float32([kb[i.trainIdx].pt for i in m]), cv2.RANSAC, 5.0)
    if H is None or mask.sum() < 10: return None
    h, w = mug.shape[:2]
    c = cv2.perspectiveTransform(np.float32([[[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]]), H)[0]
    if not cv2.isContourConvex(c) or cv2.contourArea(c, oriented=True) > -400: return None
    return c
# %%
mug, scene = load_images()
k, d = find_keypoints(mug)
drawing.show(cv2.drawKeypoints(mug, k, None, color=(0, 160, 0)), alt="k")
# %%
k2, d2 = find_keypoints(scene)
matches = match_keypoints(d, d2)
drawing.show(cv2.drawMatches(mug, k, scene, k2, matches[:40], None, flags=2), alt="m")
# %%
drawing.show(cv2.polylines(scene.copy(), [np.int32(locate_mug(mug, scene))], True, (0, 200, 0), 1), alt="o")
