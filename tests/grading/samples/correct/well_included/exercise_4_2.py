# %%
%config InlineBackend.figure_format = 'svg'
import multiprocessing, os
import matplotlib.pyplot as plt
from course_lib import camera
import cv2
import numpy as np
orb = cv2.ORB_create(2000)
bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)

# %%
class Flug:
    def __init__(self, datei): self.bilder = [b.image for b in camera.open_camera(datei)]
    def __getitem__(self, i): return self.bilder[i]
flug = Flug("flight.bag")
take_picture = flug.__getitem__
def crop_waterhole(frame): return frame[112:385, 190:442]
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

# %%
def locate_waterhole(template, frame, match_count):
    x, y = pairs(features(template), features(frame))
    return outline(template.shape, x[:match_count], y[:match_count])
# %%
def zeile(was):
    template, frame, candidates = was
    x, y = pairs(features(template), features(frame))
    return [outline(template.shape, x[:c], y[:c]) is not None for c in candidates]

def best_match_count(template, frames, candidates=range(4, 1001, 18)):
    candidates = np.array(list(candidates))
    gefunden = np.array([zeile((template, f, candidates)) for f in frames]).sum(axis=0)
    return candidates[gefunden == gefunden.max()][0]
# %%
template = crop_waterhole(take_picture(60)); cv2.imwrite("unit4/waterhole.png", template)
plt.imshow(template[..., ::-1]); plt.plot(*np.array([p.pt for p in features(template)[0]]).T, "g+"); plt.show()
# %%
fig, ax = plt.subplots()
bild = flug[44]
ax.imshow(bild[..., ::-1]); ax.add_patch(plt.Polygon(locate_waterhole(template, bild, 58), fill=False, lw=3, ec="r")); ax.axis("off")
plt.show()
# %%
c = range(4, 301, 37)
tabelle = np.array([zeile((template, flug[i], c)) for i in range(0, 100, 20)])
plt.bar(list(c), tabelle.mean(axis=0), width=25); plt.ylabel("Anteil"); plt.show()
