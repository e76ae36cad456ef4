# %%
%config InlineBackend.figure_formats = ['svg']
import base64
import cv2
import numpy as np
import matplotlib.pyplot as plt
import ipywidgets
from IPython.display import HTML, Image, display
from course_lib import images
%matplotlib inline
# %%
def load_images():
    return cv2.resize(images.load("ROS.png"), (400, 600)), cv2.resize(images.load("ROS2.png"), (600, 400))

def find_keypoints(image):
    return cv2.ORB_create(1500).detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)

def match_keypoints(q, t):
    if q is None or t is None: return []
    return sorted(cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(q, t), key=lambda m: m.distance)

def locate_mug(mug, scene, match_count=100):
    (ka, da), (kb, db) = find_keypoints(mug), find_keypoints(scene)
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
platz = display(display_id=True)
for bild in (mug, cv2.drawKeypoints(mug, k, None, color=(0, 255, 0))):
    platz.update(Image(data=cv2.imencode(".png", bild)[1].tobytes()))
# %%
k2, d2 = find_keypoints(scene)
matches = match_keypoints(d, d2)
def show_html(picture):
    data = base64.b64encode(cv2.imencode(".png", picture)[1]).decode()
    display(HTML(f'<img alt="x" src="data:image/png;base64,{data}" width="800">'))
show_html(cv2.drawMatches(mug, k, scene, k2, matches[:40], None, flags=2))
# %%
def zeige(anzahl=100):
    c = locate_mug(mug, scene, anzahl)
    plt.imshow(scene[..., ::-1])
    if c is not None:
        plt.fill(*c.T, fill=False, edgecolor="yellow", linewidth=3)
    plt.show()
ipywidgets.interact(zeige, anzahl=(20, 200, 20));
# %%
zeige()
# %% [markdown]
# Und noch etwas: wie sich Abstände und Antworten verteilen
# %%
for anzahl in range(10, 150, 10):
    plt.plot([m.distance for m in matches[:anzahl]]); plt.title(anzahl); plt.show()
