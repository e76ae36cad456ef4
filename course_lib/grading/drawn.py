"""Recognise pictures in what a notebook drew: any size, any frame around, anything drawn on top."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from course_lib._validate import Image

    Box = tuple[int, int, int, int]

# Pixels; lines and circles hardly show at this size, and the search is quick. A wide figure with
# several axes stays larger.
_LONG_SIDE, _SHORT_SIDE, _LONGEST = 144, 96, 300
_SCALES = np.geomspace(0.16, 1.0, 15)  # of the largest size that fits
_FINER = np.array([0.95, 0.97, 0.985, 1.0, 1.015, 1.03, 1.05])
_LEAST_SIDE = 20
# Of correlations: pictures under hundreds of circles or lines reach 0.7 and more, others 0.6.
_FOUND = 0.64
# Large circles with dark rims hide so much that correlation is lost. But where a picture is all
# there is, up to white margins, or has axes of its own, its place is known: then it is enough that
# this share of its pixels is as it was, to so many grey levels. Other pictures reach 0.2.
_UNTOUCHED, _SAME = 0.35, 8
_WHITE = 250
_PROPORTIONS = 0.04
# A pixel counts as drawn on when it differs by this many grey levels, after fitting brightness.
_DRAWN = 40.0
# Lines from one axes to another: of the figure's width between them, so that it is not their rims
# alone, and lines that are seen apart everywhere; what is inked for the most part is a picture.
_LEAST_GAP, _LEAST_LINES, _STILL_PAPER = 0.015, 4, 0.6


@dataclass(frozen=True)
class Sighting:
    """Where a picture shows another.

    Attributes
    ----------
    box : tuple of int
        Left, top, right, bottom, in pixels of the picture.
    likeness : float
        Correlation, up to 1.
    drawn : float
        The share of its pixels that something was drawn on.
    """

    box: Box
    likeness: float
    drawn: float


def sightings(
    picture: Image, wanted: Image, most: int = 2, places: Sequence[Box] = ()
) -> list[Sighting]:
    """Find a picture inside another, upright and in its own proportions.

    Parameters
    ----------
    picture : ndarray of uint8, shape (height, width, 3)
        What was drawn.
    wanted : ndarray of uint8, shape (height, width, 3)
        What to look for.
    most : int
        How many places to give, such as the axes of one figure.
    places : sequence of (left, top, right, bottom), optional
        What may hold a picture each, as :func:`published_flight.photo_boxes` gives it.

    Returns
    -------
    list of Sighting
        The best first; they do not overlap.
    """
    found: list[Sighting] = []
    if min(picture.shape[:2]) < _LEAST_SIDE:
        return found
    short, long = sorted(picture.shape[:2])
    shrink = min(1.0, max(_LONG_SIDE / long, min(_SHORT_SIDE / short, _LONGEST / long)))
    small = _grey(picture, shrink)
    for place in (_within_margins(picture), *places):
        untouched = _untouched(picture, place, wanted)
        known = any(_meet(place, one.box) for one in found)
        if len(found) < most and untouched >= _UNTOUCHED and not known:
            found.append(Sighting(place, untouched, drawn_share(picture, place, wanted)))
            left, top, right, bottom = (round(side * shrink) for side in place)
            small[top:bottom, left:right] = 255
    fitting = min(small.shape[0] / wanted.shape[0], small.shape[1] / wanted.shape[1])
    while len(found) < most:
        _, best = max(_scored(small, wanted, fitting * _SCALES), default=(0.0, 0.0))
        likeness, best = max(_scored(small, wanted, best * _FINER), default=(0.0, 0.0))
        if likeness < _FOUND:
            break
        template = _grey(wanted, best)
        height, width = template.shape
        x, y = cv2.minMaxLoc(_correlation(small, template))[3]
        left, top = round(x / shrink), round(y / shrink)
        right, bottom = round((x + width) / shrink), round((y + height) / shrink)
        box = (left, top, min(right, picture.shape[1]), min(bottom, picture.shape[0]))
        found.append(Sighting(box, likeness, drawn_share(picture, box, wanted)))
        small[y : y + height, x : x + width] = 255
    return found


def _meet(a: Box, b: Box) -> bool:
    return max(a[0], b[0]) < min(a[2], b[2]) and max(a[1], b[1]) < min(a[3], b[3])


def _within_margins(picture: Image) -> Box:
    """Return the box of what white margins, with or without an axis' numbers, surround."""
    ink = (picture < _WHITE).any(axis=2)
    spans = []
    for density in (ink.mean(axis=0), ink.mean(axis=1)):
        dense = np.flatnonzero(density > density.max() / 2)
        spans.append((int(dense[0]), int(dense[-1]) + 1) if len(dense) else (0, 0))
    (left, right), (top, bottom) = spans
    return left, top, right, bottom


def _untouched(picture: Image, box: Box, wanted: Image) -> float:
    """Return the share of a box that is as wanted; 0 for other proportions."""
    left, top, right, bottom = box
    width, height = right - left, bottom - top
    if min(width, height) < _LEAST_SIDE:
        return 0.0
    stretch = width / height * wanted.shape[0] / wanted.shape[1]
    if abs(stretch - 1) > _PROPORTIONS:
        return 0.0
    return 1 - _share_outside(picture[top:bottom, left:right], wanted, _SAME)


def _scored(
    small: Image, wanted: Image, scales: NDArray[np.float64]
) -> Iterator[tuple[float, float]]:
    for scale in scales:
        template = _grey(wanted, float(scale))
        if min(template.shape) >= _LEAST_SIDE and (np.array(template.shape) <= small.shape).all():
            yield float(_correlation(small, template).max()), float(scale)


def _correlation(small: Image, template: Image) -> NDArray[np.float32]:
    return np.nan_to_num(cv2.matchTemplate(small, template, cv2.TM_CCOEFF_NORMED)).astype(
        np.float32
    )


def _grey(picture: Image, scale: float) -> Image:
    size = tuple(max(1, round(side * scale)) for side in picture.shape[1::-1])
    grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
    return np.asarray(cv2.resize(grey, size, interpolation=cv2.INTER_AREA), np.uint8)


def drawn_share(picture: Image, box: Box, wanted: Image) -> float:
    """Return the share of pixels that something was drawn on.

    Parameters
    ----------
    picture : ndarray of uint8, shape (height, width, 3)
        What was drawn.
    box : (left, top, right, bottom)
        Where it shows another picture.
    wanted : ndarray of uint8, shape (height, width, 3)
        That picture, in any size.

    Returns
    -------
    float
        From 0 to 1.
    """
    left, top, right, bottom = box
    part = picture[top:bottom, left:right]
    if part.size == 0:
        return 0.0
    return _share_outside(part, wanted, _DRAWN)


def lines_cross(picture: Image, one: Box, other: Box) -> bool:
    """Tell whether lines lead from one box to another across the paper between them.

    So matplotlib draws matches between two axes. Two axes with nothing but their numbers between
    them leave some of the paper blank from top to bottom.

    Parameters
    ----------
    picture : ndarray of uint8, shape (height, width, 3)
        A figure.
    one, other : (left, top, right, bottom)
        Side by side, or one above the other.

    Returns
    -------
    bool
    """
    turned = [(top, left, bottom, right) for left, top, right, bottom in (one, other)]
    return _cross(picture, [one, other]) or _cross(picture.transpose(1, 0, 2), turned)


def _cross(picture: Image, boxes: list[Box]) -> bool:
    left, right = sorted(boxes)
    rows = slice(max(left[1], right[1]), min(left[3], right[3]))
    gap = picture[rows, left[2] : right[0]].astype(np.int16)
    if gap.shape[0] == 0 or gap.shape[1] < _LEAST_GAP * picture.shape[1]:
        return False
    inked = np.abs(gap - np.median(gap, axis=(0, 1))).max(axis=2) > _DRAWN
    return inked.mean() < _STILL_PAPER and int(inked.sum(axis=0).min()) >= _LEAST_LINES


def _share_outside(part: Image, wanted: Image, levels: float) -> float:
    """Return the share of pixels that differ by more than some grey levels from all nearby."""
    expected = cv2.resize(wanted, part.shape[1::-1], interpolation=cv2.INTER_AREA)
    # A pixel's neighbourhood allows for a place that is known to a pixel or two only.
    low, high = (op(expected, np.ones((5, 5))).astype(np.int16) for op in (cv2.erode, cv2.dilate))
    # Red and blue may be exchanged, as when matplotlib is given BGR.
    shares = []
    for channels in (part, part[..., ::-1]):
        outside = np.maximum(channels - high, low - channels).max(axis=2)
        shares.append(float((outside > levels).mean()))
    return min(shares)


def largest_set(fits: Sequence[NDArray[np.bool_]]) -> int:
    """Return how many kinds can be given pictures of their own.

    Parameters
    ----------
    fits : sequence of ndarray of bool, shape (kinds,)
        For each picture, which kinds it could be.
    """
    owner: dict[int, int] = {}

    def place(kind: int, seen: set[int]) -> bool:
        for number, could in enumerate(fits):
            if could[kind] and number not in seen:
                seen.add(number)
                if number not in owner or place(owner[number], seen):
                    owner[number] = kind
                    return True
        return False

    kinds = range(len(fits[0]) if fits else 0)
    return sum(place(kind, set()) for kind in kinds)
