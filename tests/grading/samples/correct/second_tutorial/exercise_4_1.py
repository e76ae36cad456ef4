# %%
import numpy as np, cv2
import matplotlib.pyplot as plt

# %%
# the pictures
def load_images():
    img1 = cv2.resize(cv2.imread("../images/ROS.png"), (400, 600))
    img2 = cv2.resize(cv2.imread("../images/ROS2.png"), (600, 400))
    return img1, img2

# %%
orb = cv2.ORB_create(nfeatures=1000)
def find_keypoints(image):
    g = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    k, d = orb.detectAndCompute(g, None)
    return k, d

# %%
def match_keypoints(query_descriptors, train_descriptors):
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    found = list(matcher.match(query_descriptors, train_descriptors))
    found.sort(key=lambda d: d.distance)
    return found

# %%
def locate_mug(mug, scene, match_count=100):
    k1, d1 = find_keypoints(mug)
    k2, d2 = find_keypoints(scene)
    if d2 is None:
        return None
    ms = match_keypoints(d1, d2)
    ms = ms[:match_count]
    good1 = np.float32([k1[i.queryIdx].pt for i in ms])
    good2 = np.float32([k2[i.trainIdx].pt for i in ms])
    if len(ms) < 4:
        return None
    H, status = cv2.findHomography(good1, good2, cv2.RANSAC, 3.0)
    inl = np.sum(status) if status is not None else 0
    if inl < 12:
        print("not found, only", inl, "inliers")
        return None
    hh, ww = mug.shape[0], mug.shape[1]
    c = np.float32([[0, 0], [0, hh - 1], [ww - 1, hh - 1], [ww - 1, 0]])
    c = cv2.perspectiveTransform(c.reshape(-1, 1, 2), H)
    c = np.squeeze(c)
    if not cv2.isContourConvex(c) or cv2.contourArea(c, oriented=True) > -400:
        print("not found, the outline is folded, mirrored or tiny")
        return None
    return c

# %%
img1, img2 = load_images()
k1, d1 = find_keypoints(img1)
k2, d2 = find_keypoints(img2)
both = cv2.drawKeypoints(img1, k1, None, color=(0, 0, 255), flags=0)
plt.imshow(cv2.cvtColor(both, cv2.COLOR_BGR2RGB)), plt.title("keypoints"), plt.show()

# %%
ms = match_keypoints(d1, d2)
hide = cv2.DrawMatchesFlags_NOT_DRAW_SINGLE_POINTS
lines = cv2.drawMatches(img1, k1, img2, k2, ms[:20], None, flags=hide)
plt.imshow(cv2.cvtColor(lines, cv2.COLOR_BGR2RGB)), plt.title("matches"), plt.show()
box = locate_mug(img1, img2)
img3 = cv2.polylines(img2.copy(), [np.int32(box)], True, (0, 255, 0), 5, cv2.LINE_AA)
plt.imshow(cv2.cvtColor(img3, cv2.COLOR_BGR2RGB)), plt.title("the mug"), plt.show()
