"""Find a flat object, known from one picture, in a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from course_lib._validate import Image, as_count, as_grey, as_image
from course_lib.detection import Detection
from course_lib.detectors import Detector, Features, create_detector, detect
from course_lib.evidence import BELIEVED, log10_false_alarms
from course_lib.fitting import MIN_MATCHES, RobustOptions, fit_view
from course_lib.homography import project, template_corners
from course_lib.matching import match_brute_force
from course_lib.pairs import Pairs

if TYPE_CHECKING:
    import cv2
    from numpy.typing import NDArray

__all__ = ["Detection", "TemplateLocator", "locate_template"]

# Larger pictures are searched in a reduced copy: SIFT then needs about 2 GB, ORB 100 MB.
MAX_PIXELS = 8_000_000


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
        self.ransac = RobustOptions(
            method=method,
            threshold=ransac_threshold,
            max_iterations=max_iterations,
            confidence=confidence,
            seed=seed,
        )
        self.min_inliers = as_count(min_inliers, "min_inliers", MIN_MATCHES)
        self.max_pixels = as_count(max_pixels, "max_pixels", 1)
        self.detector = create_detector(detector, n_features)
        # Without either, the descriptors' dtype decides.
        default_norm = getattr(self.detector, "defaultNorm", lambda: None)
        self.norm = default_norm() if norm is None else norm
        self.template = detect(self.detector, as_grey(template, "template"), self.max_pixels)

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
        fit = fit_view(pairs, self.template.size, scene.size, self.ransac)
        if fit is None:
            return self._nothing("RANSAC failed: no homography fits the matches", scene, matches)
        refined, inliers, fault = fit.refined, fit.inliers, fit.fault
        count = int(np.count_nonzero(inliers))
        alarms = np.inf
        if count < self.min_inliers:
            fault = (
                f"too few inliers: {count} of {len(matches)} matches, "
                f"at least {self.min_inliers} are needed"
            )
        if not fault:
            alarms = log10_false_alarms(
                refined.H, pairs, inliers, scene.points, scene.size, self.ransac.threshold
            )
            if alarms > BELIEVED:
                fault = f"too few inliers: chance can make {count} of {len(matches)} matches agree"
        if fault:
            return self._nothing(fault, scene, matches, inliers, alarms)
        return Detection(
            found=True,
            reason="",
            corners=project(refined.H, template_corners(self.template.size)).astype(np.float32),
            homography=refined.H,
            matches=matches,
            inliers=inliers,
            template_keypoints=self.template.keypoints,
            scene_keypoints=scene.keypoints,
            log10_false_alarms=alarms,
            corner_sigma=float(refined.sigma.max()),
        )

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
