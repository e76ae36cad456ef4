# %%
import numpy as np, cv2
import multiprocessing as mp
import matplotlib.pyplot as plt
from course_lib import camera
# %%
def take_picture(number):
    return [f for f, _ in zip(camera.open_camera("flight.bag"), range(number + 1))][-1].image
def crop_waterhole(frame): return np.array(frame)[110:385, 190:440]
template = crop_waterhole(take_picture(60)); cv2.imwrite("unit4/waterhole.png", template)
# %%
def features(image): return cv2.ORB_create(1000).detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)
def outlines(job):
    template, frame, counts = job
    (ka, da), (kb, db) = features(template), features(frame)
    if da is None or db is None: return [None] * len(counts)
    ms = sorted(cv2.BFMatcher(cv2.NORM_HAMMING, True).match(da, db), key=lambda m: m.distance)
    h, w = template.shape[:2]; rows = []
    for n in counts:
        some = ms[:n]
        if len(some) < 10: rows.append(None); continue
        H, mask = cv2.findHomography(np.float32([ka[m.queryIdx].pt for m in some]), np.float32([kb[m.trainIdx].pt for m in some]), cv2.RANSAC, 5.0)
        if H is None or mask.sum() < 10: rows.append(None); continue
        q = cv2.perspectiveTransform(np.float32([[[0, 0], [0, h-1], [w-1, h-1], [w-1, 0]]]), H)[0]
        rows.append(q if cv2.isContourConvex(q) and cv2.contourArea(q, True) < -1000 else None)
    return rows
def locate_waterhole(template, frame, match_count): return outlines((template, frame, [match_count]))[0]
def best_match_count(template, frames, candidates=range(4, 1001, 18)):
    candidates = list(candidates)
    with mp.get_context("fork").Pool(2) as pool:
        table = pool.map(outlines, [(template, f, candidates) for f in frames])
    found = np.array([[q is not None for q in row] for row in table]).sum(0)
    return np.array(candidates)[found.argmax()]
# %%
%matplotlib inline
import matplotlib.gridspec as gridspec
f = take_picture(44)
fig = plt.figure(figsize=(10, 4)); g = gridspec.GridSpec(1, 3)
for i, p in enumerate([cv2.drawKeypoints(template, features(template)[0], None, (0, 0, 255)), cv2.polylines(f.copy(), [np.int32(locate_waterhole(template, f, 58))], True, (255, 255, 0), 3)]):
    ax = plt.subplot(g[i]); ax.imshow(p[..., ::-1]); ax.axis("off")
ax = plt.subplot(g[2]); cs = [4, 22, 40, 58, 100, 200, 400]
ax.plot(cs, [np.mean(x) for x in zip(*[[q is not None for q in outlines((template, take_picture(i), cs))] for i in (20, 40, 80)])], "s--"); ax.set_xlabel("n")
plt.show()
