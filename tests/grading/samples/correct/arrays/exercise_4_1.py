# %%
import cv2, numpy as np, matplotlib.pyplot as plt
from matplotlib.patches import ConnectionPatch
from course_lib import images
%cd ..
# %%
def load_images():
    größen = {"ROS.png": (400, 600), "ROS2.png": (600, 400)}
    return tuple(cv2.resize(images.load(name), größe, interpolation=cv2.INTER_LANCZOS4) for name, größe in größen.items())
# %%
def find_keypoints(image):
    """Strongest first, in an array, which other arrays can index."""
    kp, des = cv2.ORB_create(1000).detectAndCompute(cv2.UMat(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)), None)
    if not len(kp): return np.array([]), None
    order = np.argsort([-k.response for k in kp], kind="stable")
    return np.array(kp, dtype=object)[order], des.get()[order]
# %%
def match_keypoints(query_descriptors, train_descriptors):
    if query_descriptors is None or train_descriptors is None: return []
    if not len(query_descriptors) or not len(train_descriptors): return []
    d = np.vstack([np.unpackbits(q ^ train_descriptors, axis=1).sum(axis=1, dtype=int) for q in query_descriptors])
    there, back = d.argmin(axis=1), d.argmin(axis=0)
    mutual = np.flatnonzero(back[there] == np.arange(len(d)))
    mutual = mutual[np.argsort(d[mutual, there[mutual]], kind="stable")]
    return np.array([cv2.DMatch(int(q), int(there[q]), float(d[q, there[q]])) for q in mutual], dtype=object)
# %%
def locate_mug(mug, scene, match_count=100):
    (ka, da), (kb, db) = find_keypoints(mug), find_keypoints(scene)
    ms = match_keypoints(da, db)[:match_count]
    if len(ms) < 10: return None
    a = np.array([k.pt for k in ka[[m.queryIdx for m in ms]]])
    b = np.array([k.pt for k in kb[[m.trainIdx for m in ms]]])
    H, mask = cv2.findHomography(a, b, cv2.USAC_ACCURATE, 5.0, maxIters=5000)
    if H is None or mask.sum() < 10: return None
    h, w = mug.shape[:2]
    q = H @ np.array([[0, 0, w - 1, w - 1], [0, h - 1, h - 1, 0], [1, 1, 1, 1]])
    q = (q[:2] / q[2]).T.astype(np.float32)
    return q if cv2.isContourConvex(q) and cv2.contourArea(q, oriented=True) < -1000 else None
# %%
mug, scene = load_images()
(ka, da), (kb, db) = find_keypoints(mug), find_keypoints(scene)
axes = plt.figure(figsize=(9, 5)).subplot_mosaic("AB")
axes["A"].imshow(cv2.drawKeypoints(mug, ka, None, (0, 160, 0))[..., ::-1])
axes["B"].imshow(scene[..., ::-1]); axes["B"].fill(*locate_mug(mug, scene).T, fill=False, ec="c", lw=3)
plt.show()
# %%
fig, (left, right) = plt.subplots(1, 2, figsize=(12, 7), width_ratios=(2, 3))
left.imshow(mug[..., ::-1]); right.imshow(scene[..., ::-1])
for m in match_keypoints(da, db)[:40]:
    fig.add_artist(ConnectionPatch(ka[m.queryIdx].pt, kb[m.trainIdx].pt, "data", "data", axesA=left, axesB=right, color="lime"))
plt.show()
