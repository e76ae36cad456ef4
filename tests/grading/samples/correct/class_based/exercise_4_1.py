# %%
import cv2
import matplotlib.pyplot as plt
import numpy as np

# %%
class MugFinder:
    """Finds the mug."""

    def __init__(self, nfeatures=1000):
        self.orb = cv2.ORB_create(nfeatures)
        self.bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)

    def keypoints(self, img):
        if img.ndim == 3:
            img = cv2.cvtColor(img, cv2.COLOR_BGR2GRAY)
        return self.orb.detectAndCompute(img, None)

    def pairs(self, d1, d2):
        if d1 is None or d2 is None:
            return []
        ms = list(self.bf.match(d1, d2))
        ms.sort(key=lambda m: m.distance)
        return ms

    def locate(self, mug, scene, n):
        k1, d1 = self.keypoints(mug)
        k2, d2 = self.keypoints(scene)
        ms = self.pairs(d1, d2)[:n]
        if len(ms) >= 4:
            p1 = np.asarray([k1[m.queryIdx].pt for m in ms], "f4")
            p2 = np.asarray([k2[m.trainIdx].pt for m in ms], "f4")
            H, ok = cv2.findHomography(p1, p2, cv2.RANSAC, 5)
            if H is not None and int(ok.sum()) > 10:
                corners = self.corners(H, *mug.shape[:2])
                if self.possible(corners):
                    return corners

    @staticmethod
    def possible(corners):
        x, y = (np.roll(corners, -1, axis=0) - corners).T
        turns = x * np.roll(y, -1) - y * np.roll(x, -1)
        return bool((turns < -100).all())  # left at every corner, and not by a hair

    @staticmethod
    def corners(H, rows, cols):
        box = [[0, 0, 1], [0, rows - 1, 1], [cols - 1, rows - 1, 1], [cols - 1, 0, 1]]
        q = np.array(box) @ H.T
        return q[:, :2] / q[:, 2:]

# %%
finder = MugFinder()

def load_images():
    a, b = (cv2.imread(f"../images/{n}.png") for n in ("ROS", "ROS2"))
    return cv2.resize(a, dsize=(400, 600)), cv2.resize(b, dsize=(600, 400))

def find_keypoints(image):
    return finder.keypoints(image)

def match_keypoints(query_descriptors, train_descriptors):
    return finder.pairs(query_descriptors, train_descriptors)

def locate_mug(mug, scene, match_count=100):
    return finder.locate(mug, scene, match_count)

# %%
fig, axes = plt.subplots(1, 3, figsize=(15, 5))
a, b = load_images()
ka, da = finder.keypoints(a)
kb, db = finder.keypoints(b)
axes[0].imshow(cv2.drawKeypoints(a, ka, None)[..., ::-1])
axes[1].imshow(cv2.drawMatches(a, ka, b, kb, finder.pairs(da, db)[:50], None)[..., ::-1])
axes[2].imshow(b[..., ::-1])
axes[2].plot(*finder.locate(a, b, 100)[[0, 1, 2, 3, 0]].T, "r-", lw=3)
for axis in axes:
    axis.axis("off")
