"""Sucht den Brunnen."""
import cv2
import numpy as np


def umriss_erlaubt(ecken, mindestfläche=1500):
    ecken = np.asarray(ecken, np.float32)
    return cv2.isContourConvex(ecken) and cv2.contourArea(ecken, oriented=True) < -mindestfläche


class Sucher:
    def __init__(self, vorlage, merkmale=1500):
        self.größe = vorlage.shape[:2]
        self.orb = cv2.ORB_create(merkmale)
        self.bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
        self.kp, self.des = self.merkmale(vorlage)

    def merkmale(self, bild):
        return self.orb.detectAndCompute(cv2.cvtColor(bild, cv2.COLOR_BGR2GRAY), None)

    def paare(self, bild):
        kp, des = self.merkmale(bild)
        if des is None or self.des is None:
            return np.zeros((2, 0, 2), np.float32)
        m = sorted(self.bf.match(self.des, des), key=lambda x: x.distance)
        return (np.float32([self.kp[x.queryIdx].pt for x in m]).reshape(-1, 2),
                np.float32([kp[x.trainIdx].pt for x in m]).reshape(-1, 2))

    def umriss(self, a, b):
        if len(a) < 10:
            return None
        H, maske = cv2.findHomography(a, b, cv2.RANSAC, 5.0, maxIters=3000)
        if H is None or maske.sum() < 10:
            return None
        h, w = self.größe
        ecken = cv2.perspectiveTransform(np.float32([[[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]]), H)[0]
        return ecken if umriss_erlaubt(ecken) else None

    def suche(self, bild, anzahl):
        a, b = self.paare(bild)
        return self.umriss(a[:anzahl], b[:anzahl])
