# %% [markdown]
# Ejercicio 4.2: busco el pozo
# %%
import cv2 as cv
import numpy as np
import matplotlib.pyplot as plt
import course_lib.camera

# %%
video = []
for fotograma in course_lib.camera.open_camera("flight.bag"):
    video.append(fotograma.image)
len(video)

# %%
def take_picture(number): return video[number]

crop_waterhole = lambda frame: frame[slice(105, 390), slice(185, 450)]

# %%
detector = cv.AKAZE_create(threshold=0.0007) if hasattr(cv, "AKAZE_create") else cv.xfeatures2d.AKAZE_create(threshold=0.0007)
def puntos(imagen):
    """Puntos clave y descriptores, como matrices."""
    k, d = detector.detectAndCompute(cv.cvtColor(imagen, cv.COLOR_BGR2GRAY), None)
    return np.float32([q.pt for q in k]).reshape(-1, 2), d

def parejas(a, b):
    (xa, da), (xb, db) = a, b
    if da is None or db is None or len(da) < 2 or len(db) < 2:
        return np.empty((0, 4), np.float32)
    emparejador = cv.DescriptorMatcher_create("BruteForce-Hamming")
    ida = emparejador.knnMatch(da, db, 2)
    vuelta = {m[0].queryIdx: m[0].trainIdx for m in emparejador.knnMatch(db, da, 2)}
    buenas = [m for m, n in ida if m.distance < 0.85 * n.distance and vuelta.get(m.trainIdx) == m.queryIdx]
    buenas = sorted(buenas, key=lambda m: m.distance)
    return np.array([[*xa[m.queryIdx], *xb[m.trainIdx]] for m in buenas], np.float32).reshape(-1, 4)

def contorno(forma, xy):
    if len(xy) < 8:
        return None
    H, dentro = cv.findHomography(xy[:, :2], xy[:, 2:], cv.USAC_MAGSAC, 3.0, None, 5000, 0.999)
    if H is None or dentro is None or cv.countNonZero(dentro) < 10:
        return None
    alto, ancho = forma[:2]
    esquinas = np.array([[0, 0, 1], [0, alto - 1, 1], [ancho - 1, alto - 1, 1], [ancho - 1, 0, 1]], float) @ H.T
    if (esquinas[:, 2] <= 0).any():
        return None
    esquinas = esquinas[:, :2] / esquinas[:, 2:]
    if not cv.isContourConvex(esquinas.astype("float32")): return None
    if cv.contourArea(esquinas.astype("float32"), oriented=True) > -0.02 * alto * ancho: return None
    return esquinas

def locate_waterhole(template, frame, match_count):
    return contorno(template.shape, parejas(puntos(template), puntos(frame))[:match_count])

# %%
def best_match_count(template, frames, candidates=range(4, 1001, 18)):
    candidates = list(candidates)
    de_plantilla = puntos(template)
    guardadas = []
    i = 0
    while i < len(frames):
        guardadas.append(parejas(de_plantilla, puntos(frames[i])))
        i += 1
    puntuacion = {}
    i = 0
    while i < len(candidates):
        puntuacion[candidates[i]] = 0
        for xy in guardadas:
            if contorno(template.shape, xy[:candidates[i]]) is not None:
                puntuacion[candidates[i]] += 1
        i += 1
    mejor = max(puntuacion.values())
    # en el medio de la meseta
    mejores = [c for c in puntuacion if puntuacion[c] == mejor]
    return mejores[len(mejores) // 2]

# %%
plantilla = crop_waterhole(video[60])
cv.imwrite("unit4/waterhole.png", plantilla)
plt.figure(figsize=(5, 5))
plt.imshow(plantilla[:, :, ::-1])
x = puntos(plantilla)[0]
plt.scatter(x[:, 0], x[:, 1], s=25, facecolors="none", edgecolors="lime")
plt.title("Puntos clave del pozo"); plt.axis("off"); plt.show()

# %%
algunos = video[0:120:12]
guardadas = [parejas(puntos(plantilla), puntos(v)) for v in algunos]
cuentas = range(4, 400, 18)
cuantos = [sum(contorno(plantilla.shape, g[:c]) is not None for g in guardadas) for c in cuentas]
plt.step(cuentas, cuantos, where="mid"); plt.xlabel("parejas"); plt.ylabel("fotogramas"); plt.show()
e = locate_waterhole(plantilla, video[44], 58)
plt.imshow(cv.cvtColor(video[44], cv.COLOR_BGR2RGB))
plt.plot(np.append(e[:, 0], e[0, 0]), np.append(e[:, 1], e[0, 1]), "y-", lw=3); plt.show()
