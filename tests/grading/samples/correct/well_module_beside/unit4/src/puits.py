"""Le puits."""
import cv2
import numpy as np

detecteur = cv2.SIFT_create(nfeatures=1500)


def racine(image):
    kp, des = detecteur.detectAndCompute(image, None)
    if des is None:
        return (), np.zeros((0, 128), np.float32)
    des = des / (des.sum(axis=1, keepdims=True) + 1e-7)
    return kp, np.sqrt(des)


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

