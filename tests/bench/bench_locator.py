"""
Frames per second: TemplateLocator against the loop of the unit's Example 4.5.

The loop makes its detector and describes the template anew for each frame, matches, and fits a
homography with OpenCV's RANSAC; it never says that the object is absent. Both see the same frames
in the same run, in interleaved rounds; the medians over the rounds are compared.

    python tests/bench/bench_locator.py [--frames N] [--rounds N] [--flight NAME]
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from pathlib import Path

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "unit"))

from scenery import TEMPLATE_SIZE, other_scene, planar_scene

from course_lib import images
from course_lib.camera import CameraError, open_camera
from course_lib.localize import TemplateLocator


def example_4_5(template, frame):
    """What the unit does in its callback, with COLOR_BGR2GRAY and a check for None."""
    height, width = template.shape[:2]
    grey_template = cv2.cvtColor(template, cv2.COLOR_BGR2GRAY)
    grey_frame = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
    orb = cv2.ORB_create(nfeatures=1000)
    train_keypoints, train_descriptors = orb.detectAndCompute(grey_template, None)
    query_keypoints, query_descriptors = orb.detectAndCompute(grey_frame, None)
    if query_descriptors is None:
        return None
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    matches = sorted(matcher.match(train_descriptors, query_descriptors), key=lambda m: m.distance)
    good = matches[:100]
    if len(good) < 4:
        return None
    source = np.float32([train_keypoints[m.queryIdx].pt for m in good]).reshape(-1, 1, 2)
    target = np.float32([query_keypoints[m.trainIdx].pt for m in good]).reshape(-1, 1, 2)
    H, _ = cv2.findHomography(source, target, cv2.RANSAC, 5.0)
    if H is None:
        return None
    corners = np.float32([[0, 0], [0, height - 1], [width - 1, height - 1], [width - 1, 0]])
    return cv2.perspectiveTransform(corners.reshape(-1, 1, 2), H).reshape(4, 2)


def flight_frames(name, count):
    """The well, cropped where it is seen whole and largest, and frames of the flight."""
    frames = [frame for frame in open_camera(name) if frame.truth]
    whole = [frame for frame in frames if frame.truth["well"]["visible"] > 0.99]
    best = max(whole, key=lambda frame: cv2.contourArea(polygon(frame)))
    x, y, width, height = cv2.boundingRect(polygon(best).astype(np.int32))
    template = best.image[max(y, 0) : y + height, max(x, 0) : x + width].copy()
    step = max(1, len(frames) // count)
    chosen = frames[::step][:count]
    return template, [(frame.image, polygon(frame)) for frame in chosen]


def polygon(frame):
    return np.array(frame.truth["well"]["polygon"], np.float32).reshape(-1, 2)


def synthetic_frames(count):
    """One template seen in scenes of the same seed's geometry, every third without it."""
    template, _, _ = planar_scene(3)
    frames = []
    for seed in range(count):
        other, scene, corners = planar_scene(seed)
        if seed % 3 == 0:
            frames.append((other_scene(seed), np.empty((0, 2), np.float32)))
            continue
        # Put our template where that scene's own template is.
        size = np.float32([[0, 0], [0, other.shape[0]], other.shape[1::-1], [other.shape[1], 0]])
        H = cv2.getPerspectiveTransform(size, corners.astype(np.float32))
        mask = cv2.warpPerspective(np.full(TEMPLATE_SIZE[::-1], 255, np.uint8), H, (640, 480))
        shown = cv2.warpPerspective(template, H, (640, 480), flags=cv2.INTER_AREA)
        scene[mask > 0] = shown[mask > 0]
        frames.append((scene, corners.astype(np.float32)))
    return template, frames


def overlap(corners, truth, size):
    """Intersection over union of a found outline with the truth, both cut to the frame."""
    canvas = [np.zeros(size, np.uint8) for _ in range(2)]
    for mask, outline in zip(canvas, (corners, truth), strict=True):
        if len(outline):
            cv2.fillPoly(mask, [np.clip(outline, -1e5, 1e5).astype(np.int32)], 1)
    both, either = np.logical_and(*canvas).sum(), np.logical_or(*canvas).sum()
    return both / either if either else 0.0


def judge(answers, frames):
    """How often the object was found where it is, was missed, and was claimed where it is not."""
    right = missed = wrong = 0
    for corners, (frame, truth) in zip(answers, frames, strict=True):
        if corners is None:
            missed += len(truth) > 0
        elif len(truth) and overlap(corners, truth, frame.shape[:2]) > 0.5:
            right += 1
        else:
            wrong += 1
    return f"{right} right, {wrong} wrong, {missed} missed"


def timed(function, frames):
    start = time.perf_counter()
    answers = [function(frame) for frame, _ in frames]
    return len(frames) / (time.perf_counter() - start), answers


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--flight", default="flight.bag")
    arguments = parser.parse_args()
    try:
        template, frames = flight_frames(arguments.flight, arguments.frames)
        source = arguments.flight
    except (CameraError, images.MissingImageError) as error:
        print(f"No flight ({error}); synthetic scenes instead.")
        template, frames = synthetic_frames(arguments.frames)
        source = "synthetic scenes"
    locator = TemplateLocator(template)
    methods = {
        "Example 4.5": lambda frame: example_4_5(template, frame),
        "TemplateLocator": lambda frame: locator.locate(frame).corners,
    }
    speeds = {name: [] for name in methods}
    answers = {}
    for _ in range(arguments.rounds):
        for name, method in methods.items():
            speed, answers[name] = timed(method, frames)
            speeds[name].append(speed)
    print(f"{len(frames)} frames of {source}, template {template.shape[1]} x {template.shape[0]}")
    for name, values in speeds.items():
        low, high = min(values), max(values)
        print(
            f"{name:16s} {statistics.median(values):7.1f} frames/s  ({low:.1f} to {high:.1f})   "
            f"{judge(answers[name], frames)}"
        )
    ratios = [b / a for a, b in zip(*speeds.values(), strict=True)]
    print(f"ratio            {statistics.median(ratios):7.2f}")


if __name__ == "__main__":
    main()
