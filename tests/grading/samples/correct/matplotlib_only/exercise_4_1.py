# %%
import cv2
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Polygon

# %%
def load_images():
    mug = cv2.imread("images/ROS.png")
    if mug is None:  # when the notebook lies one folder deeper
        mug = cv2.imread("../images/ROS.png")
    scene = cv2.imread("images/ROS2.png")
    if scene is None:
        scene = cv2.imread("../images/ROS2.png")
    return cv2.resize(mug, (400, 600)), cv2.resize(scene, (600, 400))

def find_keypoints(image):
    return cv2.ORB_create(1000, scaleFactor=1.15, nlevels=10).detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)

def match_keypoints(query_descriptors, train_descriptors):
    if query_descriptors is None or train_descriptors is None:
        return []
    pairs = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(query_descriptors, train_descriptors)
    return sorted(pairs, key=lambda p: p.distance)

def locate_mug(mug, scene, match_count=100):
    kp_a, des_a = find_keypoints(mug)
    kp_b, des_b = find_keypoints(scene)
    pairs = match_keypoints(des_a, des_b)[:match_count]
    if len(pairs) < 10:
        return None
    a = np.float32([kp_a[p.queryIdx].pt for p in pairs])
    b = np.float32([kp_b[p.trainIdx].pt for p in pairs])
    H, mask = cv2.findHomography(a, b, cv2.RANSAC, 5.0, maxIters=5000)
    if H is None or mask.sum() < 10:
        return None
    h, w = mug.shape[:2]
    quad = cv2.perspectiveTransform(np.float32([[[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]]), H)[0]
    return quad if cv2.isContourConvex(quad) else None

# %%
mug, scene = load_images()
kp_mug, des_mug = find_keypoints(mug)
kp_scene, des_scene = find_keypoints(scene)
pairs = match_keypoints(des_mug, des_scene)

plt.imshow(cv2.cvtColor(mug, cv2.COLOR_BGR2RGB))
plt.scatter(*np.array([k.pt for k in kp_mug]).T, s=14, facecolors="none", edgecolors="lime")
plt.title("keypoints")
plt.axis("off")
plt.show()

# %%
side_by_side = np.full((600, 1000, 3), 255, np.uint8)
side_by_side[:, :400] = mug
side_by_side[100:500, 400:] = scene
plt.figure(figsize=(12, 7))
plt.imshow(side_by_side[..., ::-1])
for p in pairs[:30]:
    (x1, y1), (x2, y2) = kp_mug[p.queryIdx].pt, kp_scene[p.trainIdx].pt
    plt.plot([x1, x2 + 400], [y1, y2 + 100], "o-", color="yellow", markersize=4, linewidth=0.8)
plt.axis("off")
plt.show()

# %%
plt.figure(figsize=(9, 6))
plt.imshow(scene[..., ::-1])
plt.gca().add_patch(Polygon(locate_mug(mug, scene), closed=True, fill=False, edgecolor="red", linewidth=3))
plt.axis("off")
plt.show()

# %%
# How far apart are the matches? And some more to look at.
plt.hist([p.distance for p in pairs], 30); plt.xlabel("Hamming distance"); plt.show()
plt.plot([p.distance for p in pairs]); plt.show()
plt.hist([k.size for k in kp_mug]); plt.show()
plt.hist([k.angle for k in kp_mug], 36); plt.show()
plt.imshow(cv2.cvtColor(mug, cv2.COLOR_BGR2GRAY), cmap="gray"); plt.show()
for n in (20, 50, 100, 200):
    print(n, locate_mug(mug, scene, n))
