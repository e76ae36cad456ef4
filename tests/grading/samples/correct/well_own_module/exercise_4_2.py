# %%
%matplotlib inline
import sys, cv2, numpy as np, matplotlib.pyplot as plt
sys.path.insert(0, "unit4/src")
from unit4.finder import Sucher, umriss_erlaubt
from course_lib import camera
%load_ext autoreload
%autoreload 2
# %%
def take_picture(number):
    for nr, bild in enumerate(camera.open_camera("flight.bag")):
        if nr == number: return bild.image
# %%
def crop_waterhole(frame):
    höhe, breite = frame.shape[:2]
    oben, unten, links, rechts = int(.22 * höhe), int(.81 * höhe), int(.285 * breite), int(.7 * breite)
    return frame[oben:unten, links:rechts]
vorlage = crop_waterhole(take_picture(60))
cv2.imwrite("unit4/waterhole.png", vorlage)
# %%
def locate_waterhole(template, frame, match_count):
    return Sucher(template).suche(frame, match_count)
# %%
def best_match_count(template, frames, candidates=range(4, 1001, 18)):
    sucher = Sucher(template)
    zähler = dict.fromkeys(candidates, 0)
    for bild in frames:
        paare = sucher.paare(bild)
        größte = len(paare[0])
        merker = {}
        for anzahl in candidates:
            n = min(anzahl, größte)
            if n not in merker:
                merker[n] = sucher.umriss(paare[0][:n], paare[1][:n])
            if merker[n] is not None:
                zähler[anzahl] += 1
    for anzahl, wie_oft in zähler.items():
        if wie_oft == max(zähler.values()):
            return anzahl
# %%
s = Sucher(vorlage)
fig, achsen = plt.subplots(2, 2, figsize=(12, 10))
achsen[0, 0].imshow(cv2.drawKeypoints(vorlage, s.kp, None, (0, 255, 0))[..., ::-1])
for achse, nummer in zip(achsen.flat[1:3], (44, 90)):
    b = take_picture(nummer).copy()
    e = locate_waterhole(vorlage, b, 58)
    if e is not None: cv2.polylines(b, [e.astype(int)], True, (0, 0, 255), 3)
    achse.imshow(b[..., ::-1]); achse.set_title(f"Bild {nummer}")
anzahlen = range(4, 300, 18)
bilder = [take_picture(i) for i in (10, 30, 50, 70)]
paare = [s.paare(b) for b in bilder]
achsen[1, 1].bar(list(anzahlen), [sum(s.umriss(a[:n], b[:n]) is not None for a, b in paare) for n in anzahlen], width=12)
plt.show()
