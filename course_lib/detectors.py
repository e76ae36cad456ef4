"""Keypoint detectors by name, and the features that they find in a picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import cv2
import numpy as np

from course_lib._validate import Image, as_count

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


class SupportsDetectAndCompute(Protocol):
    """What a detector of your own must offer: OpenCV's method."""

    def detectAndCompute(  # noqa: N802 (OpenCV's name)
        self, image: Image, mask: None, /
    ) -> tuple[Sequence[cv2.KeyPoint], NDArray[Any] | None]:
        """Return keypoints and descriptors (N, D), uint8 or float32, of a grey picture."""
        ...


Detector: TypeAlias = str | cv2.Feature2D | SupportsDetectAndCompute

DETECTORS = ("ORB", "SIFT", "AKAZE")

# OpenCV's detectors fail an assertion when the smallest of their pyramid's levels is empty.
MIN_SIDE = 16


@dataclass(frozen=True, eq=False)
class Features:
    """
    Keypoints of one picture with their descriptors.

    Attributes
    ----------
    keypoints : tuple of cv2.KeyPoint
        Position, size, angle and response, in pixels of the whole picture.
    points : ndarray of float32, shape (N, 2)
        The keypoints' positions (x, y).
    descriptors : ndarray, shape (N, D), or None
        uint8 (binary) or float32; None when N is 0.
    size : tuple of int
        The picture's (width, height).
    """

    keypoints: tuple[cv2.KeyPoint, ...]
    points: NDArray[np.float32]
    descriptors: NDArray[Any] | None
    size: tuple[int, int]


def create_detector(detector: Detector = "ORB", n_features: int = 1000) -> Any:  # noqa: ANN401 (any class that has OpenCV's method)
    """
    Make a detector from its name.

    Parameters
    ----------
    detector : {"ORB", "SIFT", "AKAZE"}, cv2.Feature2D, or object with ``detectAndCompute``
        An object is returned as it is, with its own settings.
    n_features : int
        How many keypoints to keep, the strongest first.

    Returns
    -------
    cv2.Feature2D, or the object itself

    Raises
    ------
    ValueError, TypeError
        Unknown name, or neither a name nor a detector.

    References
    ----------
    ORB: E. Rublee, V. Rabaud, K. Konolige, G. Bradski, ICCV 2011. SIFT: D. G. Lowe, IJCV 2004.
    AKAZE: P. F. Alcantarilla, J. Nuevo, A. Bartoli, BMVC 2013.
    """
    n_features = as_count(n_features, "n_features", 4)
    if isinstance(detector, cv2.Feature2D) and not type(detector).__module__.startswith("cv2"):
        # Its C++ part was never made, and OpenCV would take the whole kernel down.
        raise TypeError(
            f"detector {type(detector).__name__} is a Python subclass of an OpenCV class, which "
            "OpenCV cannot call; write a plain class with detectAndCompute(image, mask)"
        )
    if not isinstance(detector, str):
        if callable(getattr(detector, "detectAndCompute", None)):
            return detector
        raise TypeError(
            f"detector must be one of {', '.join(DETECTORS)} or an object with detectAndCompute, "
            f"got {detector!r}"
        )
    name = detector.upper()
    if name == "ORB":
        return cv2.ORB.create(nfeatures=n_features)
    if name == "SIFT":
        return cv2.SIFT.create(nfeatures=n_features)
    if name == "AKAZE":
        # OpenCV 5 moved AKAZE to the contributed modules; 4.x has it in cv2 itself.
        home: Any = cv2 if hasattr(cv2, "AKAZE_create") else cv2.xfeatures2d
        return home.AKAZE_create(max_points=n_features)
    raise ValueError(f"unknown detector {detector!r}; choose from {', '.join(DETECTORS)}")


def detect(detector: SupportsDetectAndCompute, grey: Image, max_pixels: int) -> Features:
    """
    Find and describe keypoints, on a reduced copy when the picture is larger than ``max_pixels``.

    Memory grows with the picture (SIFT holds about 250 bytes for each pixel), so a limit on the
    pixels is a limit on memory. Keypoints are mapped back to the whole picture.

    Parameters
    ----------
    detector : cv2.Feature2D or object with ``detectAndCompute``
    grey : ndarray of uint8, shape (H, W)
    max_pixels : int

    Returns
    -------
    Features
    """
    height, width = grey.shape
    seen = grey
    if grey.size > max_pixels:
        reduction = math.sqrt(max_pixels / grey.size)
        size = (max(1, int(width * reduction)), max(1, int(height * reduction)))
        seen = cv2.resize(grey, size, interpolation=cv2.INTER_AREA).astype(np.uint8, copy=False)
    if min(seen.shape) < MIN_SIDE:
        return Features((), np.empty((0, 2), np.float32), None, (width, height))
    keypoints, descriptors = detector.detectAndCompute(seen, None)
    if seen is not grey:
        _enlarge(keypoints, width / seen.shape[1], height / seen.shape[0])
    points = np.asarray(cv2.KeyPoint.convert(keypoints), np.float32).reshape(-1, 2)
    return Features(tuple(keypoints), points, descriptors, (width, height))


def _enlarge(keypoints: Sequence[cv2.KeyPoint], grow_x: float, grow_y: float) -> None:
    for keypoint in keypoints:
        x, y = keypoint.pt
        # Pixel centres are at integers, so it is the pixels' corners at -0.5 that stay in place.
        keypoint.pt = ((x + 0.5) * grow_x - 0.5, (y + 0.5) * grow_y - 0.5)
        keypoint.size *= math.sqrt(grow_x * grow_y)
