import subprocess
import sys

import cv2
import numpy as np
import pytest
from scenery import texture

from course_lib.detectors import create_detector, detect


@pytest.fixture(scope="module")
def grey():
    return cv2.cvtColor(texture(np.random.default_rng(5)), cv2.COLOR_BGR2GRAY)


@pytest.mark.parametrize(
    ("name", "dtype", "length"),
    [("ORB", np.uint8, 32), ("sift", np.float32, 128), ("AKAZE", np.uint8, 61)],
)
def test_by_name(grey, name, dtype, length):
    features = detect(create_detector(name, 200), grey, 10**9)
    count = len(features.keypoints)
    assert 100 < count <= 205
    assert features.descriptors.shape == (count, length)
    assert features.descriptors.dtype == dtype
    assert features.points.dtype == np.float32
    assert np.array_equal(features.points, np.float32([kp.pt for kp in features.keypoints]))
    assert features.size == (640, 480)


def test_an_object_keeps_its_settings():
    mine = cv2.ORB.create(123)
    assert create_detector(mine, 999) is mine
    assert mine.getMaxFeatures() == 123


SUBCLASS = """
import gc, os, sys
import cv2
from course_lib.detectors import create_detector
gc.disable()
class Mine(cv2.SIFT):
    pass
try:
    create_detector(Mine())
except TypeError as error:
    print(error, flush=True)
os._exit(0)
"""


def test_a_python_subclass_of_opencvs_is_refused_before_it_is_called():
    # In a process of its own: Python's garbage collector, too, crashes on such an object.
    command = [sys.executable, "-c", SUBCLASS]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "Mine is a Python subclass" in done.stdout, done.stderr


def test_a_reduced_copy_gives_points_of_the_whole(grey):
    large = cv2.resize(grey, (2560, 1920), interpolation=cv2.INTER_NEAREST)
    orb = create_detector("ORB", 300)
    reduced = detect(orb, large, max_pixels=grey.size)
    original = detect(orb, grey, max_pixels=grey.size)
    # Pixel centres at integers: pixel i of the small picture covers 4 i ... 4 i + 3.
    assert np.allclose(reduced.points, original.points * 4 + 1.5, atol=1e-3)
    assert reduced.keypoints[0].size == pytest.approx(original.keypoints[0].size * 4)
    assert np.array_equal(reduced.descriptors, original.descriptors)
    assert reduced.size == (2560, 1920)


@pytest.mark.parametrize("shape", [(1, 1), (1, 500), (15, 15), (16, 16), (16, 700)])
@pytest.mark.parametrize("name", ["ORB", "SIFT", "AKAZE"])
def test_tiny_pictures_have_no_keypoints(name, shape):
    features = detect(create_detector(name), np.zeros(shape, np.uint8), 10**6)
    assert features.keypoints == ()
    assert features.points.shape == (0, 2)
