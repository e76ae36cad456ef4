# %%
import itertools, functools
import matplotlib.pyplot as plt
import ipywidgets as widgets
from course_lib.camera import open_camera
plt.style.use("dark_background")
import cv2
import numpy as np
orb = cv2.ORB_create(2000)
bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)

@functools.lru_cache(maxsize=16)
def take_picture(number):
    with_number = enumerate(open_camera("flight.bag"))
    return next(f.image for i, f in with_number if i == number)
# %%
crop_waterhole = lambda frame: np.array(frame[100:392, 180:450], copy=True)
# %%
def features(image):
    return orb.detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)

def pairs(a, b):
    (ka, da), (kb, db) = a, b
    if da is None or db is None:
        return np.zeros((0, 2), np.float32), np.zeros((0, 2), np.float32)
    m = sorted(bf.match(da, db), key=lambda m: m.distance)
    return (np.float32([ka[i.queryIdx].pt for i in m]).reshape(-1, 2),
            np.float32([kb[i.trainIdx].pt for i in m]).reshape(-1, 2))

def outline(shape, x, y):
    if len(x) < 4:
        return None
    H, mask = cv2.findHomography(x, y, cv2.RANSAC, 5.0)
    if H is None or mask.sum() < 10:
        return None
    h, w = shape[:2]
    c = cv2.perspectiveTransform(np.float32([[[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]]), H)[0]
    return c if cv2.isContourConvex(c) and cv2.contourArea(c, oriented=True) < -0.02 * h * w else None

def locate_waterhole(template, frame, match_count):
    return outline(template.shape, *(p[:match_count] for p in pairs(features(template), features(frame))))

def best_match_count(template, frames, candidates=range(4, 1001, 18)):
    t = features(template)
    all_pairs = [pairs(t, features(f)) for f in frames]
    def found(n):
        return sum(outline(template.shape, x[:n], y[:n]) is not None for x, y in all_pairs)
    return max(candidates, key=lambda n: (found(n), -n))
# %%
template = crop_waterhole(take_picture(60))
cv2.imwrite("unit4/waterhole.png", template)
plt.imshow(cv2.drawKeypoints(template, features(template)[0], None, (0, 255, 0))[..., ::-1]); plt.axis("off"); plt.show()
# %%
@widgets.interact(number=widgets.IntSlider(44, 30, 80), n=widgets.Dropdown(options=[40, 58, 100], value=58))
def show(number=44, n=58):
    frame = take_picture(number)
    c = locate_waterhole(template, frame, n)
    plt.imshow(frame[..., ::-1])
    if c is not None:
        plt.plot(*c[[0, 1, 2, 3, 0]].T, color="cyan", lw=3)
    plt.axis("off"); plt.show()
# %%
counts = list(range(4, 300, 36))
few = [take_picture(i) for i in (20, 44, 60, 80)]
results = np.array([[locate_waterhole(template, f, n) is not None for n in counts] for f in few])
plt.plot(counts, results.mean(axis=0) * 100, "o-", color="gold"); plt.xlabel("matches"); plt.ylabel("% found"); plt.grid(alpha=.3); plt.show()
