# %%
# Übung 4.1: eine Tasse im Regal finden. Größe der Bilder: erst Breite, dann Höhe.
import cv2
import numpy as np
import matplotlib.pyplot as plt
from course_lib import images

GRÖSSE_TASSE, GRÖSSE_REGAL = (400, 600), (600, 400)
# %%
def load_images():
    """Lädt die Tasse und das Regal."""
    return cv2.resize(images.load("ROS.png"), GRÖSSE_TASSE), cv2.resize(images.load("ROS2.png"), GRÖSSE_REGAL)


def find_keypoints(bild):
    """Schlüsselpunkte und ihre Beschreibungen; für ein leeres Bild ist die Beschreibung None."""
    grau = cv2.cvtColor(bild, cv2.COLOR_BGR2GRAY)
    return cv2.ORB_create(1000).detectAndCompute(grau, None)


def match_keypoints(anfrage, ziel):
    """Ähnlichste Paare zuerst, in beiden Richtungen geprüft."""
    if anfrage is None or ziel is None:
        return []
    vergleich = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    return sorted(vergleich.match(anfrage, ziel), key=lambda paar: paar.distance)


def locate_mug(tasse, regal, anzahl=100):
    """Ecken der Tasse im Regal, sonst None."""
    punkte_t, besch_t = find_keypoints(tasse)
    punkte_r, besch_r = find_keypoints(regal)
    paare = match_keypoints(besch_t, besch_r)[:anzahl]
    if len(paare) < 4:
        return None
    von = np.float32([punkte_t[p.queryIdx].pt for p in paare])
    nach = np.float32([punkte_r[p.trainIdx].pt for p in paare])
    H, maske = cv2.findHomography(von, nach, cv2.RANSAC, 5.0)
    if H is None or maske.sum() < 10:
        print("zu wenige Übereinstimmungen")
        return None
    höhe, breite = tasse.shape[:2]
    ecken = np.float32([[0, 0], [0, höhe - 1], [breite - 1, höhe - 1], [breite - 1, 0]])
    umriss = cv2.perspectiveTransform(ecken[None], H)[0]
    möglich = cv2.isContourConvex(umriss) and -cv2.contourArea(umriss, oriented=True) > 400
    return umriss if möglich else None
# %%
tasse, regal = load_images()
punkte_t, besch_t = find_keypoints(tasse)
punkte_r, besch_r = find_keypoints(regal)
paare = match_keypoints(besch_t, besch_r)
plt.imshow(cv2.drawKeypoints(tasse, punkte_t, None, (0, 0, 255))[..., ::-1])
plt.title("Schlüsselpunkte à la ORB")
plt.show()
plt.figure(figsize=(12, 8))
plt.imshow(cv2.drawMatches(tasse, punkte_t, regal, punkte_r, paare[:40], None, flags=2)[..., ::-1])
plt.show()
plt.imshow(cv2.polylines(regal.copy(), [np.int32(locate_mug(tasse, regal))], True, (0, 200, 0), 3)[..., ::-1])
plt.show()
