"""Reject outlines that no camera could see: folded, mirrored, tiny, endless."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from course_lib.homography import project, template_corners

# Limits of what ORB and SIFT can match at all, taken generously: they lose a surface beyond about
# 60 degrees of tilt and beyond a few octaves of scale, long before these limits.
MIN_SIDE = 6.0
MAX_DEPTH_RATIO = 4.0
MIN_CORNER_SINE = math.sin(math.radians(12))
MAX_AREA_RATIO = 200.0
MIN_AREA_IN_SCENE = 0.15

Matrix = NDArray[np.float64]


def outline_fault(
    H: Matrix, template_size: tuple[int, int], scene_size: tuple[int, int]
) -> str | None:
    """
    Say why a homography cannot be a camera's view of a flat, opaque object; None if it can.

    Four matches always fit some homography exactly, so a wrong one is usual when the object is
    absent. Most wrong ones betray themselves: the outline is folded, mirrored, tiny or endless.

    Parameters
    ----------
    H : ndarray, shape (3, 3)
        H_scene_from_template.
    template_size, scene_size : tuple of int
        (width, height) in pixels.

    Returns
    -------
    str or None
    """
    source = template_corners(template_size).astype(np.float64)
    depths = source @ H[2, :2] + H[2, 2]
    if depths.min() <= 0:
        return "folded outline: part of the template would lie behind the camera"
    if depths.max() / depths.min() > MAX_DEPTH_RATIO:
        steepest = depths.max() / depths.min()
        return f"absurd perspective: one corner would be {steepest:.0f} times as far as another"
    outline = project(H, source)
    return _shape_fault(outline) or _area_fault(outline, template_size, scene_size)


def _shape_fault(outline: Matrix) -> str | None:
    sides = np.roll(outline, -1, axis=0) - outline
    following = np.roll(sides, -1, axis=0)
    turns = sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0]
    # TL, BL, BR, TR runs anticlockwise on screen, where y points down: negative turns.
    if (turns > 0).all():
        return "mirrored outline: a picture is not seen from behind"
    if not (turns < 0).all():
        return "folded outline: its corners do not form a convex shape"
    lengths = np.linalg.norm(sides, axis=1)
    if lengths.min() < MIN_SIDE:
        return f"degenerate outline: a side is {lengths.min():.1f} pixels long"
    sines = -turns / (lengths * np.roll(lengths, -1))
    if sines.min() < MIN_CORNER_SINE:
        return "degenerate outline: seen almost edge-on"
    return None


def _area_fault(
    outline: Matrix, template_size: tuple[int, int], scene_size: tuple[int, int]
) -> str | None:
    area = cv2.contourArea(outline.astype(np.float32))
    growth = area / (template_size[0] * template_size[1])
    if not 1 / MAX_AREA_RATIO <= growth <= MAX_AREA_RATIO:
        return f"absurd area: {growth:.2g} times the template's"
    shared, _ = cv2.intersectConvexConvex(outline.astype(np.float32), template_corners(scene_size))
    if shared < MIN_AREA_IN_SCENE * area:
        return f"absurd place: only {max(shared, 0) / area:.0%} of the outline lies in the scene"
    return None
