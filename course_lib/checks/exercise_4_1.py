"""The public checks of Exercise 4.1: a mug on a shelf."""

from __future__ import annotations

import contextlib
import tempfile
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from course_lib import images
from course_lib.checks.outline import must_match
from course_lib.checks.work import Check, NotYetError, Work, WrongError
from course_lib.detectors import create_detector
from course_lib.homography import project, template_corners

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from course_lib._validate import Image

MUG_SIZE, SCENE_SIZE = (400, 600), (600, 400)
# Corner errors in pixels. The print is bent around the mug, so no homography fits it; right ones
# are 10 to 20 pixels off on the shelf, wrong ones more than 100.
_SHELF_TOLERANCE = 45.0
_MADE_TOLERANCE = 15.0
# Mean difference in grey levels between a picture and itself, resized in another way.
_SAME_PICTURE = 12.0
_QUERIES = 300
# Of these queries' matches with the shelf, the share with a partner of their own: a ratio test from
# 0.7 to 0.9 leaves 0.84 and more of ORB, AKAZE, BRISK and SIFT, no test at all 0.64 to 0.77.
_LEAST_ONCE = 0.8


@cache
def mug_and_shelf() -> tuple[Image, Image]:
    """Return the pictures as the exercise wants them."""
    mug, shelf = images.load("ROS.png"), images.load("ROS2.png")
    return images.resize(mug, *MUG_SIZE), images.resize(shelf, *SCENE_SIZE)


def _peppers() -> Image:
    return images.resize(images.load("peppers.png"), *SCENE_SIZE)


def shelf_corners() -> NDArray[np.float64]:
    """Return the corners of the mug's picture on the shelf, from the truth of its print."""
    H = np.array(images.truth("ROS2.png")["objects"]["mug"]["homography_print"])
    # Both pictures shrink to two thirds, about the pixels' own corners.
    shrink = np.array([[2 / 3, 0, -1 / 6], [0, 2 / 3, -1 / 6], [0, 0, 1.0]])
    corners = template_corners(MUG_SIZE).astype(np.float64)
    return project(shrink @ H @ np.linalg.inv(shrink), corners)


def made_scenes() -> Iterator[tuple[str, Image, NDArray[np.float64]]]:
    """Yield scenes with the mug's picture on the peppers: a name, BGR, its corners."""
    mug, _ = mug_and_shelf()
    corners = template_corners(MUG_SIZE)
    outlines = {
        "turned": [[190, 130], [400, 350], [540, 215], [330, 25]],
        "upside down and small": [[390, 310], [390, 85], [240, 85], [240, 310]],
        "seen from the side": [[210, 30], [210, 370], [385, 315], [385, 95]],
    }
    for name, outline in outlines.items():
        right = np.array(outline, np.float32)
        H = cv2.getPerspectiveTransform(corners, right)
        scene = _peppers()
        seen = cv2.warpPerspective(mug, H, SCENE_SIZE, flags=cv2.INTER_AREA)
        inside = cv2.warpPerspective(np.full(mug.shape[:2], 255, np.uint8), H, SCENE_SIZE) > 127
        scene[inside] = seen[inside]
        yield name, scene, right.astype(np.float64)


def _load_images(work: Work) -> None:
    found = work.call("load_images")
    if not isinstance(found, tuple | list) or len(found) != 2:
        raise WrongError("load_images should return two pictures: return mug, scene")
    right = mug_and_shelf()
    for picture, expected, name in zip(found, right, ("mug", "scene"), strict=True):
        _is_picture(picture, expected, name, right)
    with _elsewhere(), contextlib.suppress(NotYetError, WrongError):
        again = work.call("load_images")
        if all(isinstance(picture, np.ndarray) for picture in again):
            return
    raise WrongError(
        "load_images finds its pictures only from this folder. Where your work is graded, they lie "
        'in ../images, and elsewhere cv2.imread returns None: use images.load("ROS.png"), which '
        "finds them from everywhere."
    )


def _is_picture(picture: object, expected: Image, name: str, right: tuple[Image, Image]) -> None:
    if picture is None:
        raise WrongError(
            f'The {name} is None: cv2.imread found no file. Use images.load("ROS.png").'
        )
    if not isinstance(picture, np.ndarray) or picture.dtype != np.uint8:
        raise WrongError(f"The {name} should be a picture, an array of uint8.")
    height, width = expected.shape[:2]
    if picture.shape == expected.shape[:2]:
        raise WrongError(f"The {name} is grey. Return it in colour (BGR); grey comes in step 2.")
    if picture.shape == (width, height, 3):
        raise WrongError(
            f"The {name} is {height} wide and {width} high; it should be {width} wide and {height} "
            "high. cv2.resize takes (width, height). Or are mug and scene in the wrong order?"
        )
    if picture.shape != expected.shape:
        raise WrongError(f"The {name} has shape {picture.shape}; it should be {expected.shape}.")
    if _differs(picture[:, :, ::-1], expected) <= _SAME_PICTURE < _differs(picture, expected):
        raise WrongError(f"The {name} is RGB. Leave it BGR, as OpenCV loads it.")
    if _differs(picture, expected) > _SAME_PICTURE:
        file = "ROS.png" if expected is right[0] else "ROS2.png"
        raise WrongError(f"The {name} is not {file}, or something was done to it besides resizing.")


def _differs(a: Image, b: Image) -> float:
    return float(np.abs(a.astype(np.int16) - b).mean())


@contextlib.contextmanager
def _elsewhere() -> Iterator[None]:
    """Go to a folder that has the course's pictures where a graded notebook has them."""
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder, "work")
        work.mkdir()
        for link in (work.parent / "images", work / "images"):
            link.symlink_to(images.folder())
        for name in ("ROS.png", "ROS2.png"):
            (work / name).symlink_to(images.path(name))
        with contextlib.chdir(work):
            yield


def features(work: Work, image: Image) -> tuple[Any, Any]:
    """Call the student's find_keypoints and make sure that it returns a pair."""
    found = work.call("find_keypoints", image)
    if not isinstance(found, tuple | list) or len(found) != 2:
        raise WrongError("find_keypoints should return two things: return keypoints, descriptors")
    return found[0], found[1]


def _as_list(found: Any) -> Any:  # noqa: ANN401
    """Return an array of objects, which can be indexed by arrays, as the list that it is too."""
    of_objects = isinstance(found, np.ndarray) and found.dtype == object and found.ndim == 1
    return list(found) if of_objects else found


def _find_keypoints(work: Work) -> None:
    mug, _ = mug_and_shelf()
    keypoints, descriptors = features(work, mug)
    keypoints = _as_list(keypoints)
    if isinstance(keypoints, np.ndarray) or keypoints is None:
        raise WrongError(
            "The first thing that find_keypoints returns should be the keypoints. Are keypoints "
            "and descriptors in the wrong order? Or was orb.detect called without compute?"
        )
    if not all(isinstance(each, cv2.KeyPoint) for each in keypoints):
        raise WrongError("find_keypoints should return cv2.KeyPoint objects, as ORB gives them.")
    if not isinstance(descriptors, np.ndarray) or len(descriptors) != len(keypoints):
        raise WrongError(
            "There should be one row of descriptors for each keypoint. Take both from the same "
            "call: orb.detectAndCompute(gray, None)."
        )
    if len(keypoints) < 100:
        raise WrongError(
            f"Only {len(keypoints)} keypoints on the mug, which has hundreds. Is the picture right "
            "that reaches the detector?"
        )
    gray = {code: _orb(mug, code, len(keypoints)) for code in ("BGR2GRAY", "RGB2GRAY")}
    if np.array_equal(descriptors, gray["RGB2GRAY"]) and len(descriptors) == len(keypoints):
        raise WrongError("The picture is BGR, so convert it with cv2.COLOR_BGR2GRAY.")
    features(work, np.full_like(mug, 200))  # a blank picture must not raise


def _orb(image: Image, code: str, count: int) -> Any:  # noqa: ANN401
    gray = cv2.cvtColor(image, getattr(cv2, f"COLOR_{code}"))
    return create_detector("ORB", count).detectAndCompute(gray, None)[1]


def _match_keypoints(work: Work) -> None:
    query, train = (_descriptors(work, image) for image in mug_and_shelf())
    # Fewer queries than trains, so that indices which count the wrong list stand out.
    query = query[:: max(1, len(query) // _QUERIES)]
    matches = _as_list(work.call("match_keypoints", query, train))
    if not isinstance(matches, list | tuple) or not matches:
        raise WrongError("match_keypoints should return a list of matches, and there are some.")
    if isinstance(matches[0], list | tuple):
        raise WrongError("knnMatch returns lists. Keep one match of each, and return those.")
    if not all(isinstance(match, cv2.DMatch) for match in matches):
        raise WrongError("match_keypoints should return cv2.DMatch objects, as a matcher gives.")
    distances = [match.distance for match in matches]
    if distances != sorted(distances):
        way = "the worst first" if distances == sorted(distances, reverse=True) else "not sorted"
        raise WrongError(
            f"The matches are {way}. Return sorted(matches, key=lambda m: m.distance): step 4 "
            "takes the best from the front."
        )
    if len({match.trainIdx for match in matches}) < _LEAST_ONCE * len(matches):
        raise WrongError(
            "Many keypoints of the mug share one of the scene. Ask both ways: crossCheck=True, or "
            "a ratio test."
        )
    order = np.random.default_rng(0).permutation(len(train))[:_QUERIES]
    itself = work.call("match_keypoints", train[order], train)
    if (
        sum(order[m.queryIdx] == m.trainIdx for m in itself if m.queryIdx < len(order))
        < len(order) / 2
    ):
        raise WrongError(
            "Query and train are swapped: queryIdx should count the first list of descriptors and "
            "trainIdx the second. Call matcher.match(query_descriptors, train_descriptors)."
        )


def _descriptors(work: Work, image: Image) -> Any:  # noqa: ANN401
    """Return the student's own descriptors, or ORB's where that part is not right yet."""
    with contextlib.suppress(NotYetError, WrongError):
        descriptors = features(work, image)[1]
        if isinstance(descriptors, np.ndarray) and len(descriptors) > 100:
            return descriptors
    return _orb(image, "BGR2GRAY", 1000)


def _on_the_shelf(work: Work) -> None:
    mug, shelf = mug_and_shelf()
    found = work.call("locate_mug", mug, shelf)
    must_match(found, shelf_corners(), MUG_SIZE, _SHELF_TOLERANCE, "locate_mug", "on the shelf")


def _elsewhere_too(work: Work) -> None:
    mug, _ = mug_and_shelf()
    for name, scene, right in made_scenes():
        found = work.call("locate_mug", mug, scene)
        must_match(found, right, MUG_SIZE, _MADE_TOLERANCE, "locate_mug", f"the mug {name}")


def _nowhere(work: Work) -> None:
    mug, shelf = mug_and_shelf()
    painted_over = shelf.copy()
    painted_over[165:325, 285:435] = (60, 90, 120)
    places = {
        "on a blank wall": np.full_like(shelf, 200),
        "on the peppers": _peppers(),
        "on the shelf, painted over,": painted_over,
    }
    for place, scene in places.items():
        if work.call("locate_mug", mug, scene) is not None:
            raise WrongError(
                f"There is no mug {place} and locate_mug returns an outline. Count the inliers, "
                "mask.sum(), and return None below ten; and when the outline is not convex."
            )
    if work.call("locate_mug", mug, shelf, 3) is not None:
        raise WrongError("Three matches fix no homography: return None when there are under four.")


CHECKS = (
    Check("load_images", "both pictures, in colour (BGR), at the right sizes", _load_images),
    Check("find_keypoints", "keypoints, and a descriptor for each", _find_keypoints),
    Check("match_keypoints", "cross-checked matches, the best first", _match_keypoints),
    Check("locate_mug", "finds the mug on the shelf", _on_the_shelf),
    Check("locate_mug", "finds it turned, small, seen from the side", _elsewhere_too),
    Check("locate_mug", "says None where it is not", _nowhere),
)
