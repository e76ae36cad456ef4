"""The public checks of Exercise 4.2: a waterhole, seen from a drone."""

from __future__ import annotations

from functools import cache
from itertools import islice
from numbers import Integral
from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib import camera, images
from course_lib.checks import package
from course_lib.checks.outline import as_corners, must_match
from course_lib.checks.work import Check, Work, WrongError
from course_lib.homography import template_corners

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from course_lib._validate import Image

FLIGHT = "flight.bag"
# The whole well is in these.
_OTHERS = (40, 80)
# None of it is in these. By chance, the usual pipeline gets a convex outline in the first, though
# with few inliers, and ten inliers in the second, though with a folded outline.
_NOWHERE = (123, 129)
_SEARCHED, _CANDIDATES = (20, 40, 80, 100), (4, 58, 400)
# Pixels, in the frame that the template was cut from.
_SAME_FRAME_TOLERANCE = 6.0
# The well is no plane, so outlines are judged by their overlap with its box; wrong ones have none.
_LEAST_OVERLAP = 0.35


@cache
def frames() -> dict[int, Image]:
    """Return the frames that are looked at, BGR, by their number."""
    wanted = {images.truth(FLIGHT)["template"]["frame"], *_OTHERS, *_NOWHERE, *_SEARCHED}
    with camera.open_camera(FLIGHT) as flight:
        numbered = enumerate(islice(flight, max(wanted) + 1))
        return {number: frame.image for number, frame in numbered if number in wanted}


def template() -> tuple[Image, NDArray[np.float64]]:
    """Return the well, cut out as in Example 4.5, and where its corners are in its frame."""
    about = images.truth(FLIGHT)["template"]
    x, y, w, h = about["rect"]
    crop = frames()[about["frame"]][y : y + h, x : x + w]
    return crop.copy(), template_corners((w, h)).astype(np.float64) + (x, y)


def _box(number: int) -> tuple[int, int, int, int]:
    """Return left, top, right, bottom of the well in a frame."""
    outline = np.array(images.truth(FLIGHT)["frames"][number]["well"]["polygon"])
    (left, top), (right, bottom) = outline.min(axis=0), outline.max(axis=0) + 1
    return int(left), int(top), int(right), int(bottom)


def _crop_waterhole(work: Work) -> None:
    number = images.truth(FLIGHT)["template"]["frame"]
    frame = frames()[number]
    crop = work.call("crop_waterhole", frame)
    if (
        not isinstance(crop, np.ndarray)
        or crop.dtype != np.uint8
        or crop.ndim != 3
        or not crop.size
    ):
        raise WrongError(
            "crop_waterhole should return a part of the frame, in colour. Is it empty? A slice is "
            "frame[y:y + h, x:x + w], rows first."
        )
    x, y = _found_in(crop, frame)
    height, width = crop.shape[:2]
    left, top, right, bottom = _box(number)
    both = max(0, min(x + width, right) - max(x, left)) * max(
        0, min(y + height, bottom) - max(y, top)
    )
    covered = both / ((right - left) * (bottom - top))
    filled = both / (width * height)
    if (filled >= 0.75 and covered >= 0.25) or (covered >= 0.9 and filled >= 0.4):
        return
    if abs(x - top) < 30 and abs(y - left) < 30:
        raise WrongError(
            "x and y are swapped in the crop. Rows come first: frame[y:y + h, x:x + w]."
        )
    if covered >= 0.9:
        raise WrongError(
            "The waterhole is in the crop, and much else is too. Whatever else it holds would be "
            "searched for as well: cut closer."
        )
    raise WrongError("The crop does not show the waterhole. Look at it: where is it cut off?")


def _found_in(crop: Image, frame: Image) -> tuple[int, int]:
    height, width = crop.shape[:2]
    if crop.shape[2] == 3 and height <= frame.shape[0] and width <= frame.shape[1]:
        x, y = cv2.minMaxLoc(cv2.matchTemplate(frame, crop, cv2.TM_SQDIFF))[2]
        if np.array_equal(frame[y : y + height, x : x + width], crop):
            return x, y
    raise WrongError(
        "The crop's pixels are not those of the frame. Return the slice as it is: not resized, BGR."
    )


def _same_frame(work: Work) -> None:
    well, right = template()
    frame = frames()[images.truth(FLIGHT)["template"]["frame"]]
    found = work.call("locate_waterhole", well, frame, 100)
    size = (well.shape[1], well.shape[0])
    where = "in the frame it was cut from"
    must_match(found, right, size, _SAME_FRAME_TOLERANCE, "locate_waterhole", where)


def _other_frames(work: Work) -> None:
    well, _ = template()
    for number in _OTHERS:
        found = work.call("locate_waterhole", well, frames()[number], 58)
        if found is None:
            raise WrongError(
                f"locate_waterhole returns None for frame {number}, which shows the waterhole. "
                "Print the number of inliers: is your threshold too strict?"
            )
        if _overlap(as_corners(found, "locate_waterhole"), _box(number)) < _LEAST_OVERLAP:
            raise WrongError(
                f"The outline in frame {number} is not on the waterhole. Draw the matches: are "
                "they sorted, and does queryIdx count the template's keypoints?"
            )


def _overlap(corners: NDArray[np.float64], box: tuple[int, int, int, int]) -> float:
    """Return the intersection over the union of an outline and an upright box."""
    left, top, right, bottom = box
    outline = np.clip(corners, -1e4, 1e4).astype(np.float32)
    other = np.array([[left, top], [left, bottom], [right, bottom], [right, top]], np.float32)
    if not cv2.isContourConvex(outline):
        return 0.0
    both = cv2.intersectConvexConvex(outline, other)[0]
    return float(both / (cv2.contourArea(outline) + cv2.contourArea(other) - both))


def _nowhere(work: Work) -> None:
    well, _ = template()
    places = {f"in frame {number}": frames()[number] for number in _NOWHERE}
    places["on a blank picture"] = np.full_like(frames()[_NOWHERE[0]], 200)
    for place, frame in places.items():
        if work.call("locate_waterhole", well, frame, 100) is not None:
            raise WrongError(
                f"There is no waterhole {place}, and locate_waterhole returns an outline. Count "
                "the inliers, mask.sum(): return None below ten, and when it is not convex."
            )


def _both_ends(work: Work) -> None:
    well, _ = template()
    for match_count in (3, 4, 1000):
        found = work.call("locate_waterhole", well, frames()[_OTHERS[0]], match_count)
        if found is not None:
            as_corners(found, f"locate_waterhole with match_count={match_count}")


def _best_match_count(work: Work) -> None:
    well, _ = template()
    searched = [frames()[number] for number in _SEARCHED]
    best = work.call("best_match_count", well, searched, _CANDIDATES)
    if isinstance(best, bool) or not isinstance(best, Integral):
        kind = type(best).__name__
        raise WrongError(f"best_match_count should return a whole number, not {kind}.")
    if best not in _CANDIDATES:
        raise WrongError(
            f"best_match_count returns {best}, which is not among the candidates it was given "
            f"({', '.join(map(str, _CANDIDATES))}). Try each of them, and no others."
        )
    if best == min(_CANDIDATES):
        raise WrongError(
            "With 4 matches, the outline is nearly always wrong. Any four matches agree with their "
            "own homography, so a share of inliers says nothing: count the frames in which the "
            "outline is believable."
        )


CHECKS = (
    Check("crop_waterhole", "just the waterhole, in colour", _crop_waterhole),
    Check("locate_waterhole", "finds it in the frame it was cut from", _same_frame),
    Check("locate_waterhole", "finds it in other frames", _other_frames),
    Check("locate_waterhole", "says None where it is not", _nowhere),
    Check("locate_waterhole", "takes 3, 4 and 1000 matches", _both_ends),
    Check("best_match_count", "tries every candidate on every frame", _best_match_count),
    *package.CHECKS,
)
