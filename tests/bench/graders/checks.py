"""
What each grader of the comparison asks: four public checks, four hidden tests.

`student` is whatever has the student's functions as attributes: the notebook's own names, or our
grader's proxy. The same functions run in a notebook's cells, in a test file and in a script, so
each asks the same of the same pictures.
"""

from pathlib import Path

import cv2
import numpy as np

FOLDER = Path(__file__).parent if "__file__" in globals() else Path()
TOLERANCE = 10.0  # px, of a corner
# The mug is round, so on the shelf no homography fits well: its middle must be about there.
ON_THE_SHELF, SHELF_TOLERANCE = (353.0, 245.0), 40.0


def pictures():
    return cv2.imread(str(FOLDER / "mug.png")), cv2.imread(str(FOLDER / "shelf.png"))


def moved(scale, degrees):
    """The mug alone before a grey wall, and its exact corners."""
    mug, _ = pictures()
    h, w = mug.shape[:2]
    A = cv2.getRotationMatrix2D((w / 2, h / 2), degrees, scale)
    A[:, 2] += (300 - w / 2, 200 - h / 2)
    scene = cv2.warpAffine(mug, A, (600, 400), flags=cv2.INTER_AREA, borderValue=(120, 120, 120))
    corners = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]])
    return mug, scene, corners @ A[:, :2].T + A[:, 2]


def error(corners, expected):
    assert corners is not None
    assert np.shape(corners) == (4, 2)
    return float(np.linalg.norm(np.subtract(corners, expected), axis=1).max())


def check_pictures(student):
    mug, shelf = student.load_images()
    assert mug.shape == (600, 400, 3)
    assert shelf.shape == (400, 600, 3)


def check_keypoints(student):
    keypoints, descriptors = student.find_keypoints(pictures()[0])
    assert len(keypoints) == len(descriptors) >= 50


def check_matches(student):
    (_, query), (_, train) = map(student.find_keypoints, pictures())
    distances = [match.distance for match in student.match_keypoints(query, train)]
    assert len(distances) >= 50
    assert distances == sorted(distances)


def check_shelf(student):
    corners = student.locate_mug(*pictures())
    assert error(corners, corners) == 0
    assert np.linalg.norm(corners.mean(axis=0) - ON_THE_SHELF) <= SHELF_TOLERANCE


def check_turned(student):
    mug, scene, corners = moved(0.6, 40)
    assert error(student.locate_mug(mug, scene), corners) <= TOLERANCE


def check_small(student):
    mug, scene, corners = moved(0.4, 0)
    assert error(student.locate_mug(mug, scene), corners) <= TOLERANCE


def check_dim(student):
    mug, scene, corners = moved(0.6, -15)
    dim = cv2.convertScaleAbs(scene, alpha=0.5)
    assert error(student.locate_mug(mug, dim), corners) <= TOLERANCE


def check_absent(student):
    mug, _ = pictures()
    assert student.locate_mug(mug, np.full((400, 600, 3), 200, np.uint8)) is None


PUBLIC = (check_pictures, check_keypoints, check_matches, check_shelf)
HIDDEN = (check_turned, check_small, check_dim, check_absent)
