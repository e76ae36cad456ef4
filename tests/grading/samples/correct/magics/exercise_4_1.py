# %%
%matplotlib inline
%config InlineBackend.figure_format = 'png'
import cv2, numpy as np
import matplotlib.pyplot as plt
from course_lib import images
!ls
%pwd

# %%
!python --version
cv2.ORB_create?
%who

# %%
def load_images():
    return cv2.resize(images.load("ROS.png"), (400, 600)), cv2.resize(images.load("ROS2.png"), (600, 400))

%time mug, scene = load_images()

# %%
%%time
def find_keypoints(image):
    orb = cv2.ORB_create(1500)
    return orb.detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)

k, d = find_keypoints(mug)
kk, dd = find_keypoints(scene)

# %%
def match_keypoints(query_descriptors, train_descriptors):
    if query_descriptors is None or train_descriptors is None: return []
    m = cv2.BFMatcher(cv2.NORM_HAMMING, True).match(query_descriptors, train_descriptors)
    return sorted(m, key = lambda x: x.distance)

m = match_keypoints(d, dd)
%timeit -n 1 -r 2 match_keypoints(d, dd)

# %%
%%capture said
print("this is not shown")

# %%
def locate_mug(mug, scene, match_count=100):
    k1, d1 = find_keypoints(mug)
    k2, d2 = find_keypoints(scene)
    m = match_keypoints(d1, d2)[:match_count]
    if len(m) < 12: return None
    H, mask = cv2.findHomography(np.float32([k1[x.queryIdx].pt for x in m]), np.float32([k2[x.trainIdx].pt for x in m]), cv2.RANSAC, 5)
    if H is None or mask.sum() < 12: return None
    h, w = mug.shape[:2]
    c = cv2.perspectiveTransform(np.float32([[[0, 0], [0, h-1], [w-1, h-1], [w-1, 0]]]), H)[0]
    return c if cv2.isContourConvex(c) else None

# %%
plt.imshow(cv2.drawKeypoints(mug, k, None, (0,255,0))[...,::-1]); plt.show()
plt.imshow(cv2.drawMatches(mug, k, scene, kk, m[:30], None, flags=2)[...,::-1]); plt.show()
plt.imshow(cv2.polylines(scene.copy(), [np.int32(locate_mug(mug, scene))], True, (0,255,0), 4)[...,::-1]); plt.show()

# %%
%%bash
echo "done" > done.txt
cat done.txt
