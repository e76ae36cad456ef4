"""
Warping in whole numbers, so that a seed gives the same pixels on every machine.

OpenCV's own ``warpPerspective`` differs by up to 4 grey levels between OpenCV 4 and 5, and its
floating-point kernels differ between processors. Here a sampling position is rounded to a sixteenth
of a pixel and everything after that is integer arithmetic. The four channels of a pixel ride in
the four 16-bit lanes of one 64-bit word, which makes that fast enough.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from course_lib._validate import Image

STRIP = 32  # rows at a time: the intermediate arrays then stay in the processor's cache
STEPS = 16  # bilinear weights are multiples of 1 / 16 along each axis; 16 * 16 * 255 fits 16 bits
SHIFT = 4
LANES = np.uint64(0x0001_0001_0001_0001)

Box = tuple[int, int, int, int]


def premultiplied(picture: Image) -> Image:
    """Return BGRA with the colours multiplied by alpha, as blending at an edge needs them."""
    whole = picture.astype(np.uint16)
    whole[..., :3] = (whole[..., :3] * whole[..., 3:] + 127) // 255
    return whole.astype(np.uint8)


def opaque(picture: Image) -> Image:
    """Return a BGR picture with full alpha."""
    full = np.full((*picture.shape[:2], 1), 255, np.uint8)
    return np.concatenate([picture, full], axis=2)


class Canvas:
    """
    A picture prepared for :meth:`warp`; preparing takes longer than a small warp.

    Parameters
    ----------
    picture : ndarray of uint8, shape (H, W, 4)
        BGRA, colours premultiplied by alpha. Outside it everything is transparent.
    """

    def __init__(self, picture: Image) -> None:
        self.height, self.width = picture.shape[:2]
        # Two pixels of nothing around it: what lies outside is fetched from there.
        padded = np.pad(picture, ((2, 3), (2, 3), (0, 0))).astype(np.uint16)
        self._words = np.ascontiguousarray(padded).view(np.uint64)[..., 0]

    def warp(self, H_target_from_source: NDArray[np.float64], box: Box, samples: int = 2) -> Image:
        """
        Return the part ``box`` of the target into which the picture is mapped.

        Parameters
        ----------
        H_target_from_source : ndarray, shape (3, 3)
            Pixel centres at integers in both.
        box : (left, top, right, bottom)
            Whole pixels; right and bottom are outside.
        samples : {1, 2}
            Samples along each axis of a target pixel; 2 keeps edges and shrunk prints smooth.

        Returns
        -------
        ndarray of uint8, shape (bottom - top, right - left, 4)
            Premultiplied BGRA.
        """
        left, top, right, bottom = box
        out = np.empty((bottom - top, right - left, 4), np.uint8)
        for row in range(top, bottom, STRIP):
            end = min(row + STRIP, bottom)
            out[row - top : end - top] = self._strip(
                inverse_rows(H_target_from_source), (left, row, right, end), samples
            )
        return out

    def _strip(self, inverse: NDArray[np.float64], box: Box, samples: int) -> Image:
        left, top, right, bottom = box
        across, down = np.arange(left, right), np.arange(top, bottom)
        if samples == 1:
            total = self._sample(inverse, across, down)
        else:
            total = np.zeros((len(down), len(across)), np.uint64)
            for dy in (-0.25, 0.25):
                for dx in (-0.25, 0.25):
                    part = self._sample(inverse, across + dx, down + dy)
                    # A quarter of each lane, without what falls in from the lane above.
                    total += (part >> np.uint64(2)) & (np.uint64(0x3FFF) * LANES)
        total += np.uint64(STEPS * STEPS // 2) * LANES
        lanes = total.view(np.uint16).reshape(*total.shape, 4)
        return (lanes >> 8).astype(np.uint8)

    def _sample(
        self, inverse: NDArray[np.float64], across: NDArray[np.number], down: NDArray[np.number]
    ) -> NDArray[np.uint64]:
        """Bilinear samples, each lane times 256."""
        x, y, depth = (
            row[0] * across[None, :] + (row[1] * down + row[2])[:, None] for row in inverse
        )
        columns = _sixteenths(x / depth, self.width)
        rows = _sixteenths(y / depth, self.height)
        stride = self._words.shape[1]
        place = (rows >> SHIFT) * stride + (columns >> SHIFT)
        fx, fy = (columns & (STEPS - 1)).astype(np.uint64), (rows & (STEPS - 1)).astype(np.uint64)
        gx, gy = np.uint64(STEPS) - fx, np.uint64(STEPS) - fy
        words = self._words.ravel()
        total: NDArray[np.uint64] = words.take(place, mode="clip") * (gx * gy)
        total += words.take(place + 1, mode="clip") * (fx * gy)
        total += words.take(place + stride, mode="clip") * (gx * fy)
        total += words.take(place + stride + 1, mode="clip") * (fx * fy)
        return total


def _sixteenths(position: NDArray[np.float64], size: int) -> NDArray[np.int64]:
    """Positions in the padded picture, in sixteenths; those far outside land in the padding."""
    return (np.clip(position, -2, size + 1) * STEPS + (2 * STEPS + 0.5)).astype(np.int64)


def inverse_rows(H: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the inverse of a homography up to a factor, by the adjugate: no library differs."""
    first, second, third = H.T
    return np.array([np.cross(second, third), np.cross(third, first), np.cross(first, second)])


def blend(under: Image, over: Image, box: Box) -> None:
    """
    Lay a premultiplied picture over a part of another, in place.

    Parameters
    ----------
    under : ndarray of uint8, shape (H, W, 3)
        Changed.
    over : ndarray of uint8, shape (bottom - top, right - left, 4)
    box : (left, top, right, bottom)
    """
    left, top, right, bottom = box
    part = under[top:bottom, left:right]
    clear = 255 - over[..., 3:].astype(np.uint16)
    part[...] = np.minimum(over[..., :3] + (part * clear + 127) // 255, 255)


def soften(picture: Image, passes: int) -> Image:
    """Blur with ``passes`` times the kernel (1, 2, 1) / 4 along each axis: sigma² = passes / 2."""
    for _ in range(passes):
        for axis in (0, 1):
            edge = [(1, 1) if axis == side else (0, 0) for side in range(picture.ndim)]
            wide = np.pad(picture, edge, mode="edge").astype(np.uint16)
            count = picture.shape[axis]
            low, mid, high = (np.take(wide, range(k, k + count), axis=axis) for k in range(3))
            picture = ((low + 2 * mid + high + 2) >> 2).astype(np.uint8)
    return picture


def enlarge(coarse: NDArray[np.integer], height: int, width: int) -> NDArray[np.int32]:
    """
    Enlarge a coarse grid smoothly; its outermost samples become the outermost pixels.

    Parameters
    ----------
    coarse : ndarray of integers below 2**15, shape (h, w) or (h, w, C)
    height, width : int

    Returns
    -------
    ndarray of int32, shape (height, width) or (height, width, C)
    """
    grown = coarse.astype(np.int32)
    for axis, size in ((0, height), (1, width)):
        last = grown.shape[axis] - 1
        place = np.arange(size) * (last * 256) // max(size - 1, 1)
        index = np.minimum(place >> 8, max(last - 1, 0))
        shape = [1] * grown.ndim
        shape[axis] = size
        weight = (place - (index << 8)).astype(np.int32).reshape(shape)
        near, far = np.take(grown, index, axis=axis), np.take(grown, index + (last > 0), axis=axis)
        grown = near + (((far - near) * weight) >> 8)
    return grown
