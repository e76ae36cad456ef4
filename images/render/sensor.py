"""What a real camera adds to a perfect rendering: vignetting, blur, noise, compression.

Nothing here moves a pixel, so ground truth stays exact.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

GAMMA = 2.2


def expose(
    image: NDArray[np.uint8],
    *,
    seed: int,
    light: float = 1.0,
    vignetting: float = 0.12,
    blur: float = 0.5,
    electrons: float = 6000.0,
    read_noise: float = 8.0,
    hot_pixels: float = 0.0,
) -> NDArray[np.uint8]:
    """See a rendered picture with a camera's sensor.

    Parameters
    ----------
    image : ndarray, shape (H, W, 3), uint8
        BGR.
    seed : int
        Of the noise.
    light : float
        Exposure factor on linear light; below 1 is underexposed.
    vignetting : float
        Light lost in the corners, 0 to 1.
    blur : float
        Sigma of the lens blur, pixels.
    electrons : float
        A white pixel's full well; shot noise is the square root of it.
    read_noise : float
        Standard deviation of the read-out noise, electrons.
    hot_pixels : float
        Fraction of sensor sites stuck at white or black.

    Returns
    -------
    ndarray, shape (H, W, 3), uint8
        BGR.
    """
    rng = np.random.default_rng(seed)
    height, width = image.shape[:2]
    linear = (image.astype(np.float32) / 255.0) ** GAMMA
    if blur > 0:
        linear = cv2.GaussianBlur(linear, (0, 0), blur)
    y, x = np.mgrid[:height, :width].astype(np.float32)
    centre_x, centre_y = (width - 1) / 2, (height - 1) / 2
    radius = ((x - centre_x) ** 2 + (y - centre_y) ** 2) / (centre_x**2 + centre_y**2)
    linear *= (light * (1 - vignetting * radius))[..., None]
    charge = rng.poisson(np.clip(linear, 0, None) * electrons)
    charge = charge + rng.normal(0, read_noise, charge.shape)
    seen = np.clip(charge / electrons, 0, 1) ** (1 / GAMMA)
    if hot_pixels > 0:
        # A stuck site spoils one colour: the sensor has one filter per site.
        stuck = rng.random(seen.shape) < hot_pixels
        seen[stuck] = rng.integers(0, 2, int(stuck.sum()))
    return np.round(seen * 255).astype(np.uint8)


def compress(image: NDArray[np.uint8], quality: int) -> NDArray[np.uint8]:
    """Return the picture as it looks after JPEG compression.

    Parameters
    ----------
    image : ndarray, shape (H, W, 3), uint8
        BGR.
    quality : int
        0 to 100.

    Returns
    -------
    ndarray, shape (H, W, 3), uint8
        BGR.
    """
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_UNCHANGED), dtype=np.uint8)


def save(path: Path, image: NDArray[np.uint8], quality: int = 92) -> Path:
    """Write a picture; the extension chooses PNG or JPEG.

    Parameters
    ----------
    path : Path
        Its folder is made.
    image : ndarray, uint8
        BGR, or BGRA for a PNG with transparency.
    quality : int
        Of a JPEG.

    Returns
    -------
    Path
        The same path.

    Raises
    ------
    OSError
        If the picture cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    options = {
        ".jpg": [cv2.IMWRITE_JPEG_QUALITY, quality],
        ".png": [cv2.IMWRITE_PNG_COMPRESSION, 9],
    }
    if not cv2.imwrite(str(path), image, options[path.suffix]):
        raise OSError(f"{path}: could not be written")
    return path
