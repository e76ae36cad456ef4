#!/usr/bin/env python3
"""Exercise 4.1 as a script: find the mug on the shelf.

From a terminal, without ROS:

    exercise4_1.py ROS.png ROS2.png --out pictures --show

Under ROS, started by `rosrun` or `roslaunch`, which give it arguments with `:=`, it takes the same
as private parameters:

    ~mug, ~scene  the pictures (default ROS.png and ROS2.png)
    ~out          folder for what it draws (default: the working folder)
    ~match_count  how many of the best matches to use (default 100)
    ~show         open a window until a key is pressed, where there is a display (default false)

It writes exercise4_1_keypoints.png, exercise4_1_matches.png and, if it found the mug,
exercise4_1_found.png, says where the corners are, and ends. Exit status: 0 found, 1 not found,
2 a picture cannot be read.
"""

import argparse
import os
import sys
from pathlib import Path

import cv2
import numpy as np

MUG_SIZE, SCENE_SIZE = (400, 600), (600, 400)  # width, height
MIN_INLIERS = 10
GREEN = (0, 200, 0)


def load(name, size):
    """Read a picture, BGR, and bring it to (width, height)."""
    picture = cv2.imread(str(name))
    if picture is None:  # imread does not raise
        sys.stderr.write(f"there is no picture {name}, or it cannot be read\n")
        sys.exit(2)
    return cv2.resize(picture, size, interpolation=cv2.INTER_AREA)


def find_keypoints(picture):
    """Give the ORB keypoints of a BGR picture, and their descriptors."""
    gray = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
    return cv2.ORB_create(1000).detectAndCompute(gray, None)


def match_keypoints(query_descriptors, train_descriptors):
    """Give the cross-checked matches, the smallest distance first."""
    if query_descriptors is None or train_descriptors is None:
        return []
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    return sorted(matcher.match(query_descriptors, train_descriptors), key=lambda m: m.distance)


def locate(size, keypoints_mug, keypoints_scene, matches):
    """Give the mug's corners in the scene, shape (4, 2); None when it is not there."""
    if len(matches) < 4:  # a homography needs four points
        return None
    source = np.float32([keypoints_mug[m.queryIdx].pt for m in matches])
    target = np.float32([keypoints_scene[m.trainIdx].pt for m in matches])
    homography, mask = cv2.findHomography(source, target, cv2.RANSAC, 5.0)
    if homography is None or mask.sum() < MIN_INLIERS:
        return None
    w, h = size
    outline = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]])
    corners = cv2.perspectiveTransform(outline[:, None], homography)[:, 0]
    area = -cv2.contourArea(corners, oriented=True)  # negative when it is mirrored
    return corners if cv2.isContourConvex(corners) and area > 400 else None


def run(mug_file, scene_file, out, match_count, show):
    """Find the mug, write the pictures, say where it is."""
    mug, scene = load(mug_file, MUG_SIZE), load(scene_file, SCENE_SIZE)
    keypoints_mug, descriptors_mug = find_keypoints(mug)
    keypoints_scene, descriptors_scene = find_keypoints(scene)
    matches = match_keypoints(descriptors_mug, descriptors_scene)[:match_count]
    corners = locate(MUG_SIZE, keypoints_mug, keypoints_scene, matches)

    pictures = {
        "keypoints": cv2.drawKeypoints(mug, keypoints_mug, None, color=GREEN),
        "matches": cv2.drawMatches(
            mug, keypoints_mug, scene, keypoints_scene, matches[:40], None, flags=2
        ),
    }
    if corners is not None:
        outline = np.int32(np.rint(corners))[:, None]
        pictures["found"] = cv2.polylines(scene.copy(), [outline], True, GREEN, 3, cv2.LINE_AA)
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    for name, picture in pictures.items():
        cv2.imwrite(str(folder / f"exercise4_1_{name}.png"), picture)
    where = "not found" if corners is None else np.round(corners, 1).tolist()
    print(f"mug: {where}\npictures: {folder.resolve()}", flush=True)

    if show and "DISPLAY" in os.environ:
        for name, picture in pictures.items():
            cv2.imshow(name, picture)
        cv2.waitKey(0)
        cv2.destroyAllWindows()
    return 0 if corners is not None else 1


def from_command_line():
    """Give what to do, as the arguments say."""
    parser = argparse.ArgumentParser(description="Find the mug on the shelf.")
    parser.add_argument("mug", nargs="?", default="ROS.png", help="its picture (%(default)s)")
    parser.add_argument("scene", nargs="?", default="ROS2.png", help="the shelf (%(default)s)")
    parser.add_argument("--out", default=".", metavar="FOLDER", help="for what it draws")
    parser.add_argument("--match-count", type=int, default=100, metavar="N")
    parser.add_argument("--show", action="store_true", help="open windows, if there is a display")
    options = parser.parse_args()
    return options.mug, options.scene, options.out, options.match_count, options.show


def from_parameters():
    """Give what to do, as the node's private parameters say."""
    import rospy  # noqa: PLC0415  (as a script it runs where there is no ROS)

    rospy.init_node("exercise4_1")
    defaults = {"mug": "ROS.png", "scene": "ROS2.png", "out": ".", "match_count": 100}
    values = [rospy.get_param(f"~{name}", value) for name, value in defaults.items()]
    return *values, rospy.get_param("~show", default=False)


if __name__ == "__main__":
    started_by_ros = any(":=" in argument for argument in sys.argv[1:])
    sys.exit(run(*(from_parameters() if started_by_ros else from_command_line())))
