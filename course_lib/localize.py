"""Find a flat object, known from one picture, in a scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import cv2
import numpy as np

from course_lib import homography
from course_lib._validate import Image, as_count, as_grey, as_image
from course_lib.detectors import Detector, Features, create_detector, detect
from course_lib.evidence import BELIEVED, log10_false_alarms
from course_lib.matching import match_brute_force
from course_lib.outline import outline_fault
from course_lib.pairs import Pairs
from course_lib.refine import Refined, keypoint_noise, refine, similarity
from course_lib.voting import groups

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

# Larger pictures are searched in a reduced copy: SIFT then needs about 2 GB, ORB 100 MB.
MAX_PIXELS = 8_000_000

# Four pairs fit some homography exactly, so fewer than this proves nothing.
MIN_MATCHES = 4

# Corners less certain than this part of the outline's size are no answer.
MAX_RELATIVE_SIGMA = 0.2


@dataclass(frozen=True, eq=False)
class Detection:
    """
    Where the template is in the scene; falsy when it was not found.

    Attributes
    ----------
    found : bool
    reason : str
        Why it was not found; empty when it was.
    corners : ndarray of float32, shape (4, 2), or None
        The template's corners in scene pixels (x, y): top-left, bottom-left, bottom-right,
        top-right of the template. None when not found.
    homography : ndarray of float64, shape (3, 3), or None
        H_scene_from_template, with H[2, 2] = 1. None when not found.
    matches : tuple of cv2.DMatch
        The matches used, best first; ``queryIdx`` counts template keypoints, ``trainIdx`` scene
        keypoints.
    inliers : ndarray of bool, shape (len(matches),)
        Which matches agree with the homography. When not found: with the rejected one.
    template_keypoints, scene_keypoints : tuple of cv2.KeyPoint
    log10_false_alarms : float
        Base-10 logarithm of the expected number of such agreements by chance alone (see
        :mod:`course_lib.evidence`); infinite when no homography was judged.
    corner_sigma : float
        Standard deviation of the least certain corner in pixels, as the inliers' spread and noise
        tell; infinite when not found.
    """

    found: bool
    reason: str
    corners: NDArray[np.float32] | None = None
    homography: NDArray[np.float64] | None = None
    matches: tuple[cv2.DMatch, ...] = ()
    inliers: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, np.bool_))
    template_keypoints: tuple[cv2.KeyPoint, ...] = ()
    scene_keypoints: tuple[cv2.KeyPoint, ...] = ()
    log10_false_alarms: float = np.inf
    corner_sigma: float = np.inf

    def __bool__(self) -> bool:
        return self.found

    def __repr__(self) -> str:
        agreed = f"{self.inlier_count} inliers of {len(self.matches)} matches"
        return f"Detection(found, {agreed})" if self else f"Detection(not found: {self.reason})"

    @property
    def inlier_count(self) -> int:
        """How many matches agree with the homography."""
        return int(np.count_nonzero(self.inliers))


class TemplateLocator:
    """
    Find one template in many scenes: its features are computed once.

    Parameters
    ----------
    template : ndarray, shape (H, W), (H, W, 3) or (H, W, 4)
        The object alone, seen from the front, filling the picture. BGR uint8, or what
        :func:`course_lib._validate.as_image` accepts.
    match_count : int or None
        Use only this many of the best matches; None uses all.
    detector : {"ORB", "SIFT", "AKAZE"}, cv2.Feature2D, or object with ``detectAndCompute``
    n_features : int
        Keypoints to keep in each picture (not for a detector given as an object).
    norm : int or None
        ``cv2.NORM_…``; None asks the detector.
    cross_check : bool
        Keep a match only if each descriptor is the other's nearest neighbour.
    ratio : float or None
        Lowe's ratio test; None does without.
    method : str or int
        Robust estimator, one of ``homography.METHODS``.
    ransac_threshold : float
        How far, in scene pixels, a match may be off and still be an inlier.
    max_iterations : int
        The most minimal samples the estimator tries.
    confidence : float
        Between 0 and 1; the estimator stops early when this sure.
    min_inliers : int
        Fewer inliers than this are never believed. More are believed when chance cannot explain
        them, see :mod:`course_lib.evidence`.
    seed : int
        Another seed is another random draw; the same seed is the same result.
    max_pixels : int
        A larger picture is searched in a reduced copy, which bounds memory.

    Raises
    ------
    TypeError, ValueError
        The template is not a picture, or an option is out of range.

    Examples
    --------
    >>> import cv2
    >>> import numpy as np
    >>> noise = np.random.default_rng(0).integers(0, 256, (60, 80), dtype=np.uint8)
    >>> texture = cv2.resize(noise, (640, 480), interpolation=cv2.INTER_NEAREST)
    >>> locator = TemplateLocator(texture[100:300, 200:500])
    >>> found = locator.locate(texture)
    >>> truth = [[200, 100], [200, 299], [499, 299], [499, 100]]
    >>> bool(found), bool(np.abs(found.corners - truth).max() < 6)
    (True, True)
    >>> locator.locate(np.zeros((480, 640), np.uint8))
    Detection(not found: too few keypoints: the scene has 0, at least 4 are needed)
    """

    def __init__(
        self,
        template: Image,
        *,
        match_count: int | None = 100,
        detector: Detector = "ORB",
        n_features: int = 1000,
        norm: int | None = None,
        cross_check: bool = True,
        ratio: float | None = None,
        method: str | int = "USAC_MAGSAC",
        ransac_threshold: float = 5.0,
        max_iterations: int = 2000,
        confidence: float = 0.999,
        min_inliers: int = 7,
        seed: int = 0,
        max_pixels: int = MAX_PIXELS,
    ) -> None:
        self.match_count = (
            None if match_count is None else as_count(match_count, "match_count", MIN_MATCHES)
        )
        self.cross_check = cross_check
        self.ratio = ratio
        self.method = homography.method_code(method)
        if not 0 < ransac_threshold < np.inf:
            raise ValueError(f"ransac_threshold must be positive, got {ransac_threshold}")
        self.ransac_threshold = float(ransac_threshold)
        self.max_iterations = as_count(max_iterations, "max_iterations", 1)
        if not 0 < confidence < 1:
            raise ValueError(f"confidence must be between 0 and 1, got {confidence}")
        self.confidence = float(confidence)
        self.min_inliers = as_count(min_inliers, "min_inliers", MIN_MATCHES)
        self.seed = as_count(seed, "seed", 0)
        self.max_pixels = as_count(max_pixels, "max_pixels", 1)
        self.detector = create_detector(detector, n_features)
        # Without either, the descriptors' dtype decides.
        default_norm = getattr(self.detector, "defaultNorm", lambda: None)
        self.norm = default_norm() if norm is None else norm
        self.template = detect(self.detector, as_grey(template, "template"), self.max_pixels)
        self._corners = homography.template_corners(self.template.size).astype(np.float64)

    def locate(self, frame: Image) -> Detection:
        """
        Find the template in one scene.

        Parameters
        ----------
        frame : ndarray, shape (H, W), (H, W, 3) or (H, W, 4)
            BGR uint8, or what :func:`course_lib._validate.as_image` accepts.

        Returns
        -------
        Detection
            Falsy, with a reason, when the template is not there.

        Raises
        ------
        TypeError, ValueError
            The frame is not a picture.
        """
        scene = detect(self.detector, as_grey(frame, "frame"), self.max_pixels)
        for features, name in ((self.template, "template"), (scene, "scene")):
            if len(features.keypoints) < MIN_MATCHES:
                return self._nothing(
                    f"too few keypoints: the {name} has {len(features.keypoints)}, "
                    f"at least {MIN_MATCHES} are needed",
                    scene,
                )
        matches = match_brute_force(
            self.template.descriptors,
            scene.descriptors,
            cross_check=self.cross_check,
            ratio=self.ratio,
            norm=self.norm,
        )[: self.match_count]
        if len(matches) < self.min_inliers:
            return self._nothing(
                f"too few matches: {len(matches)}, at least {self.min_inliers} are needed",
                scene,
                tuple(matches),
            )
        return self._judge(scene, tuple(matches))

    def _judge(self, scene: Features, matches: tuple[cv2.DMatch, ...]) -> Detection:
        pairs = Pairs.of(matches, self.template, scene)
        best: tuple[int, Refined, NDArray[np.bool_], str] | None = None
        for members in self._candidates(pairs):
            fit = self._fit(pairs, members, scene.size)
            if fit is None:
                continue
            refined, inliers, fault = fit
            # A possible outline is better than any impossible one.
            score = int(np.count_nonzero(inliers)) - (len(matches) + 1 if fault else 0)
            if best is None or score > best[0]:
                best = (score, refined, inliers, fault)
        if best is None:
            return self._nothing("RANSAC failed: no homography fits the matches", scene, matches)
        _, refined, inliers, fault = best
        count = int(np.count_nonzero(inliers))
        alarms = np.inf
        if count < self.min_inliers:
            fault = (
                f"too few inliers: {count} of {len(matches)} matches, "
                f"at least {self.min_inliers} are needed"
            )
        if not fault:
            alarms = log10_false_alarms(
                refined.H, pairs, inliers, scene.points, scene.size, self.ransac_threshold
            )
            if alarms > BELIEVED:
                fault = f"too few inliers: chance can make {count} of {len(matches)} matches agree"
        if fault:
            return self._nothing(fault, scene, matches, inliers, alarms)
        return Detection(
            found=True,
            reason="",
            corners=homography.project(refined.H, self._corners).astype(np.float32),
            homography=refined.H,
            matches=matches,
            inliers=inliers,
            template_keypoints=self.template.keypoints,
            scene_keypoints=scene.keypoints,
            log10_false_alarms=alarms,
            corner_sigma=float(refined.sigma.max()),
        )

    def _candidates(self, pairs: Pairs) -> Iterator[NDArray[np.intp]]:
        """Yield the sets of matches that RANSAC is tried upon."""
        if pairs.oriented:
            yield from groups(pairs, self.ransac_threshold)
        else:
            yield np.arange(len(pairs))

    def _fit(
        self, pairs: Pairs, members: NDArray[np.intp], scene_size: tuple[int, int]
    ) -> tuple[Refined, NDArray[np.bool_], str] | None:
        """Return the polished homography, its inliers, and what is wrong with it, if anything."""
        source, target = pairs.template_points, pairs.scene_points
        H = homography.estimate(
            source[members],
            target[members],
            method=self.method,
            threshold=self.ransac_threshold,
            max_iterations=self.max_iterations,
            confidence=self.confidence,
            seed=self.seed,
        )
        if H is None:
            return None
        inliers = self._inliers(H, pairs)
        if np.count_nonzero(inliers) < MIN_MATCHES:
            return None
        if outline_fault(H, self.template.size, scene_size):
            # Too few inliers, too close together, for their perspective to mean anything.
            H = similarity(source[inliers], target[inliers])
        refined: Refined | None = None
        # The group was an approximation: inliers outside it widen the support.
        for _ in range(2):
            noise = keypoint_noise(H, source[inliers], pairs.noise[inliers])
            polished = refine(H, source[inliers], target[inliers], noise, self._corners)
            if polished is None:
                break
            refined, H = polished, polished.H
            before, inliers = inliers, self._inliers(H, pairs)
            if np.array_equal(before, inliers) or np.count_nonzero(inliers) < MIN_MATCHES:
                break
        if refined is None:
            return None
        fault = outline_fault(H, self.template.size, scene_size) or self._vagueness(refined)
        return refined, inliers, fault

    def _vagueness(self, refined: Refined) -> str:
        """Say so if the inliers leave the outline open."""
        area = cv2.contourArea(homography.project(refined.H, self._corners).astype(np.float32))
        sigma = float(refined.sigma.max())
        if sigma <= MAX_RELATIVE_SIGMA * np.sqrt(area):
            return ""
        return (
            "degenerate inliers: they cover too little of the template to fix its corners "
            f"(uncertain by {sigma:.0f} pixels)"
        )

    def _inliers(self, H: homography.Matrix, pairs: Pairs) -> NDArray[np.bool_]:
        errors = homography.reprojection_errors(H, pairs.template_points, pairs.scene_points)
        return errors <= self.ransac_threshold

    def _nothing(
        self,
        reason: str,
        scene: Features,
        matches: tuple[cv2.DMatch, ...] = (),
        inliers: NDArray[np.bool_] | None = None,
        alarms: float = np.inf,
    ) -> Detection:
        return Detection(
            found=False,
            reason=reason,
            matches=matches,
            inliers=np.zeros(len(matches), np.bool_) if inliers is None else inliers,
            template_keypoints=self.template.keypoints,
            scene_keypoints=scene.keypoints,
            log10_false_alarms=alarms,
        )


def locate_template(
    template: Image,
    scene: Image,
    *,
    match_count: int | None = 100,
    detector: Detector = "ORB",
    n_features: int = 1000,
    norm: int | None = None,
    cross_check: bool = True,
    ratio: float | None = None,
    method: str | int = "USAC_MAGSAC",
    ransac_threshold: float = 5.0,
    max_iterations: int = 2000,
    confidence: float = 0.999,
    min_inliers: int = 7,
    seed: int = 0,
    max_pixels: int = MAX_PIXELS,
) -> Detection:
    """
    Find a flat object, known from one picture, in a scene.

    Keypoints of both pictures are matched, and a homography is fitted to the best matches. It is
    believed only if it shows the template as a camera could see it and if chance cannot explain
    how many matches agree. Use :class:`TemplateLocator`, whose options these are, for a stream.

    Parameters
    ----------
    template, scene : ndarray, shape (H, W), (H, W, 3) or (H, W, 4)
        BGR uint8, or what :func:`course_lib._validate.as_image` accepts.
    match_count, detector, n_features, norm, cross_check, ratio, method, ransac_threshold, \
    max_iterations, confidence, min_inliers, seed, max_pixels
        See :class:`TemplateLocator`.

    Returns
    -------
    Detection
        Falsy, with a reason, when the template is not there.

    Raises
    ------
    TypeError, ValueError
        A picture is not a picture, or an option is out of range.

    Examples
    --------
    >>> import numpy as np
    >>> blank = np.full((100, 100, 3), 255, np.uint8)
    >>> detection = locate_template(blank, blank)
    >>> bool(detection), detection.corners
    (False, None)
    >>> detection.reason
    'too few keypoints: the template has 0, at least 4 are needed'
    """
    as_image(scene, "scene")  # a wrong scene is named as such, and before the work begins
    locator = TemplateLocator(
        template,
        match_count=match_count,
        detector=detector,
        n_features=n_features,
        norm=norm,
        cross_check=cross_check,
        ratio=ratio,
        method=method,
        ransac_threshold=ransac_threshold,
        max_iterations=max_iterations,
        confidence=confidence,
        min_inliers=min_inliers,
        seed=seed,
        max_pixels=max_pixels,
    )
    return locator.locate(scene)
