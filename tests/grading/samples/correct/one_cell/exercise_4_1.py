# %%
#!/usr/bin/env python3
import argparse
import sys

import cv2
import matplotlib.pyplot as plt
import numpy as np

from course_lib import images


def load_images():
    mug = cv2.resize(images.load("ROS.png"), (400, 600), interpolation=cv2.INTER_AREA)
    scene = cv2.resize(images.load("ROS2.png"), (600, 400), interpolation=cv2.INTER_AREA)
    return [mug, scene]


def find_keypoints(image):
    orb = cv2.ORB_create(2000)
    keypoints, descriptors = orb.detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)
    return [keypoints, descriptors]


def match_keypoints(query_descriptors, train_descriptors):
    if query_descriptors is None or train_descriptors is None:
        return ()
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    return tuple(sorted(matcher.match(query_descriptors, train_descriptors), key=lambda m: m.distance))


def locate_mug(mug, scene, match_count=100):
    kp1, des1 = find_keypoints(mug)
    kp2, des2 = find_keypoints(scene)
    best = match_keypoints(des1, des2)[:match_count]
    if len(best) < 10:
        return None
    src = np.float64([kp1[m.queryIdx].pt for m in best])
    dst = np.float64([kp2[m.trainIdx].pt for m in best])
    h_scene_from_mug, inliers = cv2.findHomography(src, dst, cv2.RANSAC, 4.0)
    if h_scene_from_mug is None or sum(inliers.ravel().tolist()) < 10:
        return None
    h, w = mug.shape[:2]
    corners = []
    for x, y in ((0, 0), (0, h - 1), (w - 1, h - 1), (w - 1, 0)):
        u, v, d = h_scene_from_mug @ (x, y, 1)
        corners.append([u / d, v / d])
    if not cv2.isContourConvex(np.float32(corners)):
        return None
    return corners


def main(argv=None):
    parser = argparse.ArgumentParser()
    parser.add_argument("--matches", type=int, default=30)
    args, _ = parser.parse_known_args(argv)
    mug, scene = load_images()
    kp1, des1 = find_keypoints(mug)
    kp2, des2 = find_keypoints(scene)
    matches = match_keypoints(des1, des2)[: args.matches]
    pictures = [
        cv2.drawKeypoints(mug, kp1, None, color=(0, 255, 0)),
        cv2.drawMatches(mug, kp1, scene, kp2, matches, None, flags=2),
        cv2.polylines(scene.copy(), [np.int32(locate_mug(mug, scene))], True, (0, 255, 0), 3),
    ]
    for picture in pictures:
        plt.figure(figsize=(10, 7))
        plt.imshow(picture[..., ::-1])
        plt.show()
    return 0


if __name__ == "__main__":
    main()
