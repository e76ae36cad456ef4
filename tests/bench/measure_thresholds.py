"""
How far off honest methods are on held-out scenes: what the grader's thresholds rest upon.

    python tests/bench/measure_thresholds.py [--seeds N] [--first SEED] [--kind KIND …] [--counts]

Each pipeline is one that a good student may hand in, written out plainly. Printed for each kind of
scene: how many were found, the median and the 95th and 100th percentile of the corner error (RMS
of the four corners' distances, scene pixels), and, where the mug is absent, how often that was
said. With `--counts`, instead: which share of the points for the well each match count leaves, the
mean over seeds and the worst seed's (12 seeds take some minutes).
"""

from __future__ import annotations

import argparse
import time
from functools import partial

import cv2
import numpy as np

from course_lib import images
from course_lib.grading import published_flight
from course_lib.grading.geometry import corner_error, expected_outline, well_credit
from course_lib.scenes import KINDS, flight, mug_scene

MIN_INLIERS = 10


def orb(keypoints=1000):
    return cv2.ORB_create(nfeatures=keypoints), cv2.NORM_HAMMING


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

COUNTS = (10, 22, 58, 100, 400)
COUNTED = {
    "ORB 1000, cross-check": (orb, None),
    "ORB 2000, cross-check": (partial(orb, 2000), None),
    "ORB 1000, ratio 0.8": (orb, 0.8),
    "SIFT, cross-check": (sift, None),
    "SIFT, ratio 0.75": (sift, 0.75),
    "AKAZE, cross-check": (akaze, None),
    "AKAZE, ratio 0.8": (akaze, 0.8),
    "ORB 500, cross-check": (partial(orb, 500), None),
}


def matched(template, scene, norm, ratio):
    if ratio is None:
        matches = cv2.BFMatcher(norm, crossCheck=True).match(template, scene)
    else:
        pairs = cv2.BFMatcher(norm).knnMatch(template, scene, k=2)
        matches = [p[0] for p in pairs if len(p) == 2 and p[0].distance < ratio * p[1].distance]
    return sorted(matches, key=lambda match: match.distance)


def found_corners(template, scene, pipeline):
    """What a good student returns: corners, or None when too little agrees."""
    make, count, ratio = PIPELINES[pipeline]
    points = matched_points(template, scene, make, ratio)
    return outline(template, *(each[:count] for each in points))


def matched_points(template, scene, make, ratio):
    """Give the points of all matches, best first, in the template and in the scene."""
    detector, norm = make()
    keypoints, descriptors = zip(
        *(
            detector.detectAndCompute(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), None)
            for picture in (template, scene)
        ),
        strict=True,
    )
    if any(each is None or len(each) < 4 for each in descriptors):
        return np.empty((0, 2), np.float32), np.empty((0, 2), np.float32)
    matches = matched(*descriptors, norm, ratio)
    source = np.float32([keypoints[0][match.queryIdx].pt for match in matches])
    target = np.float32([keypoints[1][match.trainIdx].pt for match in matches])
    return source.reshape(-1, 2), target.reshape(-1, 2)


def outline(template, source, target):
    """Give the corners that these matches stand for, if one may believe them."""
    if len(source) < 4:
        return None
    homography, mask = cv2.findHomography(source, target, cv2.RANSAC, 5.0)
    if homography is None or mask.sum() < MIN_INLIERS:
        return None
    h, w = template.shape[:2]
    box = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]).reshape(-1, 1, 2)
    corners = cv2.perspectiveTransform(box, homography)
    if not cv2.isContourConvex(corners):
        return None
    return corners.reshape(4, 2)


def mug_rows(kinds, pipelines, seeds):
    for kind in kinds:
        made = [mug_scene(seed, kind=kind) for seed in seeds]
        for pipeline in pipelines:
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


def count_rows(seeds):
    """Yield a pipeline, and for each match count the mean credit over seeds and the worst."""
    about = images.truth(published_flight.FLIGHT)["template"]
    x, y, w, h = about["rect"]
    template = published_flight.frame(about["frame"])[y : y + h, x : x + w]
    there = published_flight.silhouette(about["frame"])
    for pipeline, (make, ratio) in COUNTED.items():
        credits_ = {count: [] for count in COUNTS}
        for seed in seeds:
            whole = [frame for frame in flight(seed, n_frames=12).frames if frame.whole]
            right = [expected_outline((x, y, w, h), there, frame.polygon) for frame in whole]
            points = [matched_points(template, frame.image, make, ratio) for frame in whole]
            for count in COUNTS:
                found = [outline(template, a[:count], b[:count]) for a, b in points]
                credits_[count].append(np.mean(list(map(well_credit, found, right))))
        yield pipeline, {count: (np.mean(all_), min(all_)) for count, all_ in credits_.items()}


def print_counts(seeds):
    print("| Pipeline | " + " | ".join(f"{count} matches" for count in COUNTS) + " |")
    print("|---" * (len(COUNTS) + 1) + "|")
    for pipeline, row in count_rows(seeds):
        columns = " | ".join(f"{mean:.2f} / {worst:.2f}" for mean, worst in row.values())
        print(f"| {pipeline} | {columns} |", flush=True)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--kind", nargs="+", default=list(KINDS), choices=KINDS)
    parser.add_argument("--pipeline", nargs="+", default=list(PIPELINES), choices=PIPELINES)
    parser.add_argument("--counts", action="store_true")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
    print(f"OpenCV {cv2.__version__}, {options.seeds} seeds for each row")
    if options.counts:
        print_counts(seeds)
        return
    print("| Kind | Pipeline | Found (absent: said so) | 50 % | 90 % | 95 % | 100 % |")
    print("|---|---|---|---|---|---|---|")
    for kind, pipeline, share, errors, _ in mug_rows(options.kind, options.pipeline, seeds):
        columns = "| | |"
        if errors is not None:
            columns = " | ".join(
                f"{np.quantile(errors, q, method='higher'):.1f}" for q in (0.5, 0.9, 0.95, 1)
            )
        print(f"| {kind} | {pipeline} | {share:.0%} | {columns} |", flush=True)


if __name__ == "__main__":
    main()
