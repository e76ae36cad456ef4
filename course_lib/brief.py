"""BRIEF's sampling geometries: which pairs of pixels of a patch are compared."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

GEOMETRIES = ("G I", "G II", "G III", "G IV", "G V")

# The coarse polar grid of G IV and G V: rings by directions, and the centre.
RINGS, DIRECTIONS = 8, 32


def sampling_pairs(
    geometry: str, n_tests: int = 256, patch_size: int = 31, *, seed: int = 0
) -> NDArray[np.int32]:
    """
    Choose the pairs of pixels that BRIEF compares.

    Parameters
    ----------
    geometry : {"G I", "G II", "G III", "G IV", "G V"}
        With S for the patch's size [1]_: "G I" draws both pixels uniformly from the patch;
        "G II" both from a Gaussian of variance S²/25 round the centre; "G III" the first so and
        the second from a Gaussian of variance S²/100 round the first; "G IV" both from the points
        of a coarse polar grid; "G V" keeps the first at the centre and lets the second go through
        the polar grid.
    n_tests : int
        Number of pairs; BRIEF-16, -32 and -64 have 128, 256 and 512.
    patch_size : int
        Side of the square patch in pixels, odd.
    seed : int
        Another seed is another draw; two descriptors can be compared only if drawn alike.

    Returns
    -------
    ndarray of int32, shape (n_tests, 4)
        x1, y1, x2, y2 in pixels from the patch's centre.

    Raises
    ------
    ValueError
        Unknown geometry, no tests, or a patch size that is not odd and at least 3.

    References
    ----------
    .. [1] M. Calonder, V. Lepetit, C. Strecha, P. Fua, "BRIEF: Binary Robust Independent
       Elementary Features", ECCV 2010, section 3.2.

    Examples
    --------
    >>> pairs = sampling_pairs("G II")
    >>> pairs.shape, int(abs(pairs).max()) <= 15
    ((256, 4), True)
    >>> bool((sampling_pairs("G V")[:, :2] == 0).all())
    True
    """
    if geometry not in GEOMETRIES:
        raise ValueError(f"geometry must be one of {', '.join(GEOMETRIES)}, got {geometry!r}")
    if n_tests < 1:
        raise ValueError(f"n_tests must be at least 1, got {n_tests}")
    if patch_size < 3 or patch_size % 2 == 0:
        raise ValueError(f"patch_size must be odd and at least 3, got {patch_size}")
    rng = np.random.default_rng([seed, GEOMETRIES.index(geometry)])
    half = patch_size // 2
    shape = (n_tests, 2)
    if geometry == "G I":
        first, second = rng.uniform(-half - 0.5, half + 0.5, (2, *shape))
    elif geometry == "G II":
        first, second = rng.normal(0, patch_size / 5, (2, *shape))
    elif geometry == "G III":
        first = rng.normal(0, patch_size / 5, shape)
        second = rng.normal(first, patch_size / 10)
    else:
        grid = _polar_grid(half)
        if geometry == "G IV":
            first, second = grid[rng.integers(len(grid), size=(2, n_tests))]
        else:
            first, second = np.zeros(shape), grid[rng.permutation(np.arange(n_tests) % len(grid))]
    # A Gaussian has tails: what falls outside is drawn to the patch's border.
    pairs = np.clip(np.rint(np.hstack([first, second])), -half, half)
    return np.asarray(pairs, np.int32)


def _polar_grid(half: int) -> NDArray[np.float64]:
    radii = np.linspace(half / RINGS, half, RINGS)
    angles = np.arange(DIRECTIONS) * 2 * np.pi / DIRECTIONS
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    grid: NDArray[np.float64] = (radii[:, None, None] * around).reshape(-1, 2)
    return grid
