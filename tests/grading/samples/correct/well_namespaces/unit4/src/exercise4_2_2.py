#!/usr/bin/env python3
# -*- coding: utf-8 -*-
import cv2 as cv
import numpy as np
import rospy
import cv_bridge
import geometry_msgs.msg
import sensor_msgs.msg
import std_msgs.msg
from functools import partial

detector = cv.AKAZE_create(threshold=0.0007) if hasattr(cv, "AKAZE_create") else cv.xfeatures2d.AKAZE_create(threshold=0.0007)
puente = cv_bridge.CvBridge()

def puntos(imagen):
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

def busca(plantilla, referencia, publica_imagen, publica_esquinas, mensaje):
    imagen = puente.imgmsg_to_cv2(mensaje, "bgr8")
    e = contorno(plantilla.shape, parejas(referencia, puntos(imagen))[:rospy.get_param("~cuantas", 100)])
    salida = geometry_msgs.msg.PolygonStamped()
    salida.header = std_msgs.msg.Header(stamp=mensaje.header.stamp, frame_id=mensaje.header.frame_id)
    if e is not None:
        salida.polygon = geometry_msgs.msg.Polygon([geometry_msgs.msg.Point32(*p, 0) for p in e.tolist()])
        cv.drawContours(imagen, [e.round().astype(int).reshape(-1, 1, 2)], 0, (0, 255, 255), 3)
    publica_esquinas(salida)
    m = puente.cv2_to_imgmsg(imagen, "bgr8"); m.header = mensaje.header
    publica_imagen(m)

rospy.init_node("pozo")
plantilla = cv.imread(rospy.get_param("~plantilla"))
rospy.Subscriber("image_raw", sensor_msgs.msg.Image, partial(busca, plantilla, puntos(plantilla),
    rospy.Publisher("image", sensor_msgs.msg.Image, queue_size=None, latch=True).publish,
    rospy.Publisher("corners", geometry_msgs.msg.PolygonStamped, queue_size=3).publish), queue_size=1)
while not rospy.is_shutdown():
    rospy.sleep(0.5)
