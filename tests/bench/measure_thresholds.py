"""
How far off honest methods are on held-out scenes: what the grader's thresholds rest upon.

    python tests/bench/measure_thresholds.py [--seeds N] [--first SEED] [--kind KIND …]

Each pipeline is one that a good student may hand in, written out plainly. Printed for each kind of
scene: how many were found, the median and the 95th and 100th percentile of the corner error (RMS
of the four corners' distances, scene pixels), and, where the mug is absent, how often that was
said.
"""

from __future__ import annotations

import argparse
import time

import cv2
import numpy as np

from course_lib.grading.geometry import corner_error
from course_lib.scenes import KINDS, mug_scene

MIN_INLIERS = 10


def orb():
    return cv2.ORB_create(nfeatures=1000), cv2.NORM_HAMMING


def sift():
    return cv2.SIFT_create(), cv2.NORM_L2


def akaze():
    # It moved in OpenCV 5.
    create = getattr(cv2, "AKAZE_create", None) or cv2.xfeatures2d.AKAZE_create
    return create(), cv2.NORM_HAMMING


# Detector, matches to keep, ratio (None: cross-check).
PIPELINES = {
    "ORB, best 100": (orb, 100, None),
    "ORB, all": (orb, None, None),
    "SIFT, ratio": (sift, None, 0.75),
    "AKAZE, best 100": (akaze, 100, None),
    "AKAZE, ratio": (akaze, None, 0.8),
}


def matched(template, scene, norm, count, ratio):
    if ratio is None:
        matches = cv2.BFMatcher(norm, crossCheck=True).match(template, scene)
    else:
        pairs = cv2.BFMatcher(norm).knnMatch(template, scene, k=2)
        matches = [p[0] for p in pairs if len(p) == 2 and p[0].distance < ratio * p[1].distance]
    return sorted(matches, key=lambda match: match.distance)[:count]


def found_corners(template, scene, pipeline):
    """What a good student returns: corners, or None when too little agrees."""
    make, count, ratio = PIPELINES[pipeline]
    detector, norm = make()
    keypoints, descriptors = zip(
        *(
            detector.detectAndCompute(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), None)
            for picture in (template, scene)
        ),
        strict=True,
    )
    if any(each is None or len(each) < 4 for each in descriptors):
        return None
    matches = matched(*descriptors, norm, count, ratio)
    if len(matches) < 4:
        return None
    source = np.float32([keypoints[0][match.queryIdx].pt for match in matches])
    target = np.float32([keypoints[1][match.trainIdx].pt for match in matches])
    homography, mask = cv2.findHomography(source, target, cv2.RANSAC, 5.0)
    if homography is None or mask.sum() < MIN_INLIERS:
        return None
    h, w = template.shape[:2]
    outline = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]).reshape(-1, 1, 2)
    corners = cv2.perspectiveTransform(outline, homography)
    if not cv2.isContourConvex(corners):
        return None
    return corners.reshape(4, 2)


def mug_rows(kinds, seeds):
    for kind in kinds:
        made = [mug_scene(seed, kind=kind) for seed in seeds]
        for pipeline in PIPELINES:
            start = time.perf_counter()
            results = [found_corners(each.mug, each.scene, pipeline) for each in made]
            milliseconds = 1000 * (time.perf_counter() - start) / len(made)
            if kind == "absent":
                said = sum(result is None for result in results)
                yield kind, pipeline, said / len(made), None, milliseconds
                continue
            errors = np.array(
                [
                    np.inf if result is None else corner_error(result, each.corners)
                    for result, each in zip(results, made, strict=True)
                ]
            )
            yield kind, pipeline, float(np.mean(errors < 60)), errors, milliseconds


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--kind", nargs="+", default=list(KINDS), choices=KINDS)
    options = parser.parse_args()
    print(f"OpenCV {cv2.__version__}, {options.seeds} seeds for each row")
    print("| Kind | Pipeline | Found (absent: said so) | 50 % | 90 % | 95 % | 100 % |")
    print("|---|---|---|---|---|---|---|")
    for kind, pipeline, share, errors, _ in mug_rows(
        options.kind, range(options.first, options.first + options.seeds)
    ):
        columns = "| | |"
        if errors is not None:
            columns = " | ".join(
                f"{np.quantile(errors, q, method='higher'):.1f}" for q in (0.5, 0.9, 0.95, 1)
            )
        print(f"| {kind} | {pipeline} | {share:.0%} | {columns} |", flush=True)


if __name__ == "__main__":
    main()
