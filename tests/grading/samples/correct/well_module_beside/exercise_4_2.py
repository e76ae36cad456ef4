# %%
import functools
import cv2
import numpy as np
import PIL.Image
import matplotlib.pyplot as plt
from IPython.display import display
from course_lib import camera, check, drawing
from course_lib.progress import track

# %%
@functools.lru_cache(maxsize=None)
def take_picture(number):
    """Retourne une image du vol."""
    for i, frame in enumerate(camera.open_camera("flight.bag")):
        if i >= number:
            return frame.image

# %%
def crop_waterhole(frame):
    """Découpe le puits : d'abord un masque, puis son rectangle."""
    mask = np.zeros(frame.shape[:2], np.uint8)
    cv2.fillPoly(mask, [np.array([[192, 118], [192, 380], [438, 380], [438, 118]])], 255)
    x, y, w, h = cv2.boundingRect(mask)
    return cv2.bitwise_and(frame, frame, mask=mask)[y:y+h, x:x+w]

# %%
class Puits:
    """Le modèle du puits."""
    detecteur = cv2.SIFT_create(nfeatures=1500)

    @classmethod
    def racine(cls, image):
        kp, des = cls.detecteur.detectAndCompute(image, None)
        if des is None:
            return (), np.zeros((0, 128), np.float32)
        des = des / (des.sum(axis=1, keepdims=True) + 1e-7)
        return kp, np.sqrt(des)

def locate_all(template, frame, counts):
    (kt, dt), (kf, df) = Puits.racine(template), Puits.racine(frame)
    return corners_for(template.shape, kt, kf, mutual(dt, df), counts)

def mutual(dt, df):
    """Plus proches voisins mutuels, sans BFMatcher."""
    if not len(dt) or not len(df):
        return np.zeros((0, 2), int)
    likeness = dt @ df.T
    forth, back = likeness.argmax(1), likeness.argmax(0)
    i = np.flatnonzero(back[forth] == np.arange(len(dt)))
    order = np.argsort(-likeness[i, forth[i]], kind="stable")
    return np.stack([i, forth[i]], 1)[order]

def corners_for(shape, kt, kf, ij, counts):
    answers, known = {}, {}
    for n in counts:
        best = ij[:n]
        if len(best) not in known:
            known[len(best)] = one(shape, [kt[i].pt for i, _ in best], [kf[j].pt for _, j in best])
        answers[n] = known[len(best)]
    return answers

def one(shape, a, b):
    if len(a) < 10:
        return None
    a, b = np.asarray(a, float), np.asarray(b, float)
    H, mask = cv2.findHomography(a, b, cv2.RHO, 5.0)
    if H is None or mask is None or mask.sum() < 10:
        return None
    good = mask.ravel() == 1
    H2, _ = cv2.findHomography(a[good], b[good], 0)
    H = H2 if H2 is not None else H
    h, w = shape[:2]
    q = cv2.perspectiveTransform(np.array([[[0., 0.]], [[0., h - 1.]], [[w - 1., h - 1.]], [[w - 1., 0.]]]), H).reshape(4, 2)
    sides = np.roll(q, -1, 0) - q
    nxt = np.roll(sides, -1, 0)
    turns = sides[:, 0] * nxt[:, 1] - sides[:, 1] * nxt[:, 0]
    return q if (turns < 0).all() and 0.1 < np.sqrt(abs(cv2.contourArea(q.astype(np.float32))) / (h * w)) < 4 else None

def locate_waterhole(template, frame, match_count):
    return locate_all(template, frame, [match_count])[match_count]

# %%
def best_match_count(template, frames, candidates=range(4, 1001, 18)):
    t = Puits.racine(template)
    table = []
    for frame in track(frames, "frames"):
        f = Puits.racine(frame)
        row = corners_for(template.shape, t[0], f[0], mutual(t[1], f[1]), candidates)
        table.append([row[c] is not None for c in candidates])
    total = np.sum(table, axis=0)
    return int(min(c for c, n in zip(candidates, total) if n == total.max()))

# %%
modele = crop_waterhole(take_picture(60))
assert cv2.imwrite("unit4/waterhole.png", modele)
kp = Puits.racine(modele)[0]
display(PIL.Image.fromarray(cv2.drawKeypoints(modele, kp, None, color=(0, 160, 0))[:, :, ::-1]))

# %%
vue = take_picture(44).copy()
coins = locate_waterhole(modele, vue, 58)
cv2.polylines(vue, [coins.astype(np.int32)], True, (0, 255, 0), 2)
display(PIL.Image.fromarray(cv2.cvtColor(vue, cv2.COLOR_BGR2RGB)))

# %%
images = [f.image for f in camera.open_camera("flight.bag")][::30]
comptes = list(range(4, 1001, 18))
lignes = [locate_all(modele, image, comptes) for image in images]
part = [np.mean([l[c] is not None for l in lignes]) for c in comptes]
meilleur = comptes[int(np.argmax(part))]
with plt.style.context("ggplot"):
    fig, ax = plt.subplots(figsize=(7, 3))
    ax.plot(comptes, part, drawstyle="steps-post")
    ax.axvline(meilleur, ls=":")
    ax.set(xlabel="nombre d'appariements", ylabel="part des images")
    display(fig)
    plt.close(fig)
meilleur
