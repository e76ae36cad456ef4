"""The drone's front camera: a pinhole without distortion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

SIZE = (640, 480)  # width, height in pixels
HFOV = float(np.radians(64.0))


def camera_matrix() -> NDArray[np.float64]:
    """Return K, shape (3, 3), in pixels; pixel centres are at integers."""
    w, h = SIZE
    focal = w / 2 / np.tan(HFOV / 2)
    return np.array([[focal, 0, (w - 1) / 2], [0, focal, (h - 1) / 2], [0, 0, 1]])
