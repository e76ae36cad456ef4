"""The library on the course's own rendered pictures, against the renderer's truth."""

import cv2
import numpy as np
import pytest

from course_lib import images
from course_lib.camera import open_camera
from course_lib.localize import TemplateLocator, locate_template

BOX_SCENES = ["box_in_scene", "box_in_scene_rotated", "box_in_scene_hidden"]


def named(stem):
    """A picture's full name; whether it is a PNG or a JPEG is the renderer's choice."""
    (name,) = [n for n in images.names() if n.rsplit(".", 1)[0] == stem]
    return name


def needs(*files):
    """Skip while a picture is not rendered yet; CI takes a skip for a failure."""
    absent = [file for file in files if not any(images.folder().glob(file))]
    return pytest.mark.skipif(bool(absent), reason=f"not rendered: {', '.join(absent)}")


def corner_error(detection, corners):
    return np.linalg.norm(detection.corners - np.array(corners), axis=1).max()


@needs("box.png", *(f"{scene}.*" for scene in BOX_SCENES))
@pytest.mark.parametrize("options", [{}, {"detector": "SIFT"}, {"match_count": None}], ids=str)
@pytest.mark.parametrize("scene", BOX_SCENES)
def test_the_box_is_found_where_it_is(scene, options):
    name = named(scene)
    box = images.truth(name)["objects"]["box"]
    detection = locate_template(images.load("box.png"), images.load(name), **options)
    assert detection, detection.reason
    # Glare and things on top leave some corners without matches near them; the detection must know.
    assert corner_error(detection, box["corners"]) < max(5, min(15, 2 * detection.corner_sigma))


def mug_and_shelf():
    mug = images.resize(images.load("ROS.png"), width=400, height=600)
    return mug, images.resize(images.load("ROS2.png"), width=600, height=400)


@needs("ROS.png", "ROS2.png")
def test_the_mug_is_found_on_the_shelf():
    mug, shelf = mug_and_shelf()
    detection = locate_template(mug, shelf)
    assert detection, detection.reason
    assert detection.inlier_count >= 15


@needs("ROS.png", "ROS2.png", "peppers.png", "box_in_scene_rotated.*", "heldout/background_*")
@pytest.mark.parametrize("match_count", [100, None])
def test_no_mug_no_detection(match_count):
    mug, _ = mug_and_shelf()
    locator = TemplateLocator(mug, match_count=match_count)
    backgrounds = [name for name in images.names("heldout") if "background" in name]
    assert backgrounds
    for name in [*backgrounds, "peppers.png", "box.png", named("box_in_scene_rotated")]:
        detection = locator.locate(images.load(name))
        assert not detection, name


def well(frame):
    return np.array(frame.truth["well"]["polygon"], np.float32).reshape(-1, 2)


@pytest.fixture(scope="module")
def flight():
    with open_camera("flight.bag") as source:
        return list(source)


@needs("flight.bag")
def test_the_flight_has_its_truth(flight):
    assert len(flight) >= 240
    assert all(frame.truth for frame in flight)
    assert {frame.image.shape for frame in flight} == {(480, 640, 3)}
    stamps = [frame.stamp_ns for frame in flight]
    assert stamps == sorted(set(stamps))


@needs("flight.bag")
def test_the_well_is_found_in_the_flight_and_nowhere_else(flight):
    whole = [frame for frame in flight if frame.truth["well"]["visible"] > 0.99]
    best = max(whole, key=lambda frame: cv2.contourArea(well(frame)))
    x, y, width, height = cv2.boundingRect(well(best).astype(np.int32))
    locator = TemplateLocator(best.image[y : y + height, x : x + width].copy())
    found = beside = 0
    for frame in flight[::4]:
        detection = locator.locate(frame.image)
        if not detection:
            continue
        found += 1
        outline = well(frame)
        centre = tuple(float(value) for value in detection.corners.mean(axis=0))
        beside += len(outline) < 3 or cv2.pointPolygonTest(outline, centre, measureDist=True) < -20
    assert found >= len(flight[::4]) * 0.2
    assert beside == 0
