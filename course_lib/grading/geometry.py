"""Judge outlines: how far off, how many of the points that leaves, which usual mistake it is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from course_lib.grading.mistakes import diagnose, recognise
from course_lib.grading.outlines import (
    as_outline,
    corner_error,
    expected_outline,
    is_convex,
    means_nothing,
    outline_overlap,
    reformed,
)
from course_lib.grading.thresholds import FORM, MUG, MUG_COVERED, WELL, Tolerance

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = [
    "absent_credit",
    "as_outline",
    "corner_credit",
    "corner_error",
    "credit",
    "diagnose",
    "expected_outline",
    "is_convex",
    "mug_credit",
    "outline_overlap",
    "recognise",
    "well_credit",
]


def credit(error: float, tolerance: Tolerance) -> float:
    """
    Return which share of the points an error leaves.

    Between ``tolerance.full`` and ``tolerance.none`` it falls smoothly with the error's logarithm:
    half of the points remain at their geometric mean.

    Parameters
    ----------
    error : float
        Such as :func:`corner_error` gives; NaN counts as infinite.
    tolerance : Tolerance

    Returns
    -------
    float
        From 0 to 1.

    Examples
    --------
    >>> [round(credit(error, Tolerance(10, 40)), 2) for error in (3, 10, 14, 20, 30, 40)]
    [1.0, 1.0, 0.86, 0.5, 0.1, 0.0]
    """
    if error <= tolerance.full:
        return 1.0
    if not error < tolerance.none:
        return 0.0
    way = math.log(error / tolerance.full) / math.log(tolerance.none / tolerance.full)
    return (1 + math.cos(math.pi * way)) / 2


def corner_credit(found: object, true: ArrayLike, tolerance: Tolerance) -> float:
    """
    Return which share of the points four corners get.

    Right corners in another order, or in OpenCV's own shape (4, 1, 2), get :data:`FORM` of it: the
    work is done, what was asked for is not given.

    Parameters
    ----------
    found : object
        What the submission returned.
    true : array_like, shape (4, 2)
    tolerance : Tolerance

    Returns
    -------
    float
        From 0 to 1.
    """
    exact = credit(corner_error(found, true), tolerance)
    return max(exact, FORM * credit(corner_error(reformed(found, true), true), tolerance))


def absent_credit(found: object) -> float:
    """
    Return the share of the points for an answer where there is nothing to find.

    Parameters
    ----------
    found : object
        What the submission returned. None is right; an empty list, zeros or a text say the same in
        another form, and get :data:`FORM`.

    Returns
    -------
    float
        From 0 to 1.
    """
    if found is None:
        return 1.0
    return FORM if means_nothing(found) else 0.0


def mug_credit(found: object, true: ArrayLike | None, kind: str = "plain") -> float:
    """
    Return the share of the points for one scene of :func:`course_lib.scenes.mug_scene`.

    Parameters
    ----------
    found : object
        What the submission returned.
    true : array_like, shape (4, 2), or None
        None: the mug is absent; see :func:`absent_credit`.
    kind : str
        The scene's kind; a covered mug is allowed more.

    Returns
    -------
    float
        From 0 to 1.
    """
    if true is None:
        return absent_credit(found)
    tolerance = MUG_COVERED if kind == "cover" else MUG
    return corner_credit(found, true, tolerance)


def well_credit(found: object, expected: ArrayLike | None) -> float:
    """
    Return the share of the points for one frame of :func:`course_lib.scenes.flight`.

    Parameters
    ----------
    found : object
        What the submission returned.
    expected : array_like, shape (4, 2), or None
        What :func:`expected_outline` gives for the student's crop; None: the well is not in the
        frame; see :func:`absent_credit`.

    Returns
    -------
    float
        From 0 to 1.
    """
    if expected is None:
        return absent_credit(found)
    return credit(1 - outline_overlap(found, expected), WELL)
