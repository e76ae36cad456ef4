"""SIFT, FLANN and a ratio test in a class with type hints; German names; a wide crop."""

# %%
from __future__ import annotations
from dataclasses import dataclass
from typing import Iterable, Sequence
import cv2
import numpy as np
import numpy.typing as npt
import matplotlib.pyplot as plt
from course_lib import camera

Bild = npt.NDArray[np.uint8]

# %%
def take_picture(number: int) -> Bild:
    """Gibt ein Bild der Aufnahme zurück (BGR)."""
    with camera.open_camera("flight.bag") as aufnahme:
        for nummer, bild in enumerate(aufnahme):
            if nummer == number:
                return bild.image
    raise IndexError(number)

# %%
@dataclass(frozen=True)
class Ausschnitt:
    links: int = 165
    oben: int = 90
    breite: int = 300
    hoehe: int = 310

    def von(self, bild: Bild) -> Bild:
        return bild[self.oben : self.oben + self.hoehe, self.links : self.links + self.breite]

def crop_waterhole(frame: Bild) -> Bild:
    """Schneidet den Brunnen aus."""
    return Ausschnitt().von(frame)

vorlage = crop_waterhole(take_picture(60))
cv2.imwrite("unit4/waterhole.png", vorlage)

# %%
class Finder:
    """Sucht eine Vorlage in Bildern; Merkmale der Vorlage nur einmal."""

    def __init__(self, vorlage: Bild, n: int | None = None) -> None:
        self.sift = cv2.SIFT_create(contrastThreshold=0.03)
        self.flann = cv2.FlannBasedMatcher(dict(algorithm=1, trees=5), dict(checks=80))
        self.vorlage, self.n = vorlage, n
        self.kp, self.des = self.sift.detectAndCompute(vorlage, None)
        self._cache: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def paare(self, bild: Bild) -> tuple[np.ndarray, np.ndarray]:
        leer = np.zeros((0, 1, 2), np.float32)
        kp, des = self.sift.detectAndCompute(bild, None)
        if des is None or len(des) < 2 or self.des is None:
            return leer, leer
        gut = []
        for beide in self.flann.knnMatch(self.des, des, k=2):
            if len(beide) == 2 and beide[0].distance < 0.77 * beide[1].distance:
                gut.append(beide[0])
        if not gut:
            return leer, leer
        gut.sort(key=lambda m: m.distance)
        a = np.float32([self.kp[m.queryIdx].pt for m in gut]).reshape(-1, 1, 2)
        b = np.float32([kp[m.trainIdx].pt for m in gut]).reshape(-1, 1, 2)
        return a, b

    def umriss(self, a: np.ndarray, b: np.ndarray) -> np.ndarray | None:
        if len(a) < 10:
            return None
        H, maske = cv2.findHomography(a, b, cv2.RANSAC, 5.0)
        if H is None or int(maske.sum()) < 10:
            return None
        h, w = self.vorlage.shape[:2]
        ecken = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]).reshape(-1, 1, 2)
        ecken = cv2.perspectiveTransform(ecken, H)
        if not cv2.isContourConvex(ecken) or cv2.contourArea(ecken, True) > -200:
            return None
        return ecken.reshape(4, 2)

def locate_waterhole(template: Bild, frame: Bild, match_count: int) -> np.ndarray | None:
    """Die vier Ecken, oder None."""
    finder = Finder(template)
    a, b = finder.paare(frame)
    return finder.umriss(a[:match_count], b[:match_count])

def best_match_count(template: Bild, frames: Sequence[Bild], candidates: Iterable[int] = range(4, 1001, 18)) -> int:
    """Bei welcher Anzahl die meisten Bilder einen Umriss haben."""
    candidates = sorted(candidates)
    finder = Finder(template)
    scores: dict[int, int] = {c: 0 for c in candidates}
    for frame in frames:
        a, b = finder.paare(frame)
        bekannt: dict[int, bool] = {}
        for c in candidates:
            n = min(c, len(a))
            if n not in bekannt:
                bekannt[n] = finder.umriss(a[:n], b[:n]) is not None
            scores[c] += bekannt[n]
    return max(candidates, key=lambda c: scores[c])

# %%
bilder = [f.image for f in camera.open_camera("flight.bag")][::30]
ziel = take_picture(44)
ecken = locate_waterhole(vorlage, ziel, 58)
fig, achsen = plt.subplots(1, 2, figsize=(12, 5))
mit = cv2.drawKeypoints(vorlage, Finder(vorlage).kp, None, color=(0, 255, 255), flags=cv2.DRAW_MATCHES_FLAGS_DRAW_RICH_KEYPOINTS)
achsen[0].imshow(cv2.cvtColor(mit, cv2.COLOR_BGR2RGB)); achsen[0].axis("off")
achsen[1].imshow(cv2.cvtColor(ziel, cv2.COLOR_BGR2RGB))
achsen[1].add_patch(plt.Polygon(ecken, closed=True, fill=False, edgecolor="red", linewidth=3)); achsen[1].axis("off")
plt.show()

# %%
zahlen = list(range(4, 1001, 54))
finder = Finder(vorlage)
anteile = []
alle = [finder.paare(b) for b in bilder]
for c in zahlen:
    anteile.append(np.mean([finder.umriss(a[:c], b[:c]) is not None for a, b in alle]))
plt.plot(zahlen, anteile, "o-"); plt.xlabel("Anzahl"); plt.ylabel("Anteil"); plt.grid(); plt.show()
print(best_match_count(vorlage, bilder))
