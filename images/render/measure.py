"""Measure how the unit's own pipeline fares on the pictures; print it, or put it in the README.

`python images/render/measure.py [--write]`, in the course's environment (not the renderer's).

The pipeline: ORB_create(1000) on grey, brute-force Hamming with cross-check, the best matches,
findHomography with RANSAC at 5 pixels. Nothing refines, checks or rejects what it finds.
"""

from __future__ import annotations

import argparse
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from course_lib import images
from course_lib.camera import open_camera

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Features = tuple[Sequence[cv2.KeyPoint], NDArray[np.uint8] | None]
    Record = dict[str, Any]

README = Path(__file__).resolve().parent.parent / "README.md"
BEGIN, END = "<!-- measured: begin -->\n", "<!-- measured: end -->\n"
COUNTS = (4, 22, 40, 58, 76, 100, 200, None)
FOUND_IOU = 0.6
WHOLE = 0.99  # a silhouette with at least this much in the frame counts as fully visible


def features(image: NDArray[np.uint8]) -> Features:
    """Detect and describe with the unit's settings.

    Parameters
    ----------
    image : ndarray, shape (H, W, 3), uint8
        BGR.

    Returns
    -------
    keypoints : sequence of cv2.KeyPoint
    descriptors : ndarray, shape (N, 32), uint8, or None
    """
    grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    return cv2.ORB_create(1000).detectAndCompute(grey, None)


def match(template: Features, scene: Features) -> list[cv2.DMatch]:
    """Return the cross-checked matches, best first.

    Parameters
    ----------
    template, scene : Features

    Returns
    -------
    list of cv2.DMatch
    """
    if template[1] is None or scene[1] is None:
        return []
    found = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(template[1], scene[1])
    return sorted(found, key=lambda m: m.distance)


def fit(
    template: Features, scene: Features, matches: Sequence[cv2.DMatch]
) -> tuple[NDArray[np.float64] | None, int]:
    """Fit the homography to matches.

    Parameters
    ----------
    template, scene : Features
    matches : sequence of cv2.DMatch

    Returns
    -------
    H_scene_from_template : ndarray, shape (3, 3), or None
    inliers : int
    """
    if len(matches) < 4:
        return None, 0
    source = np.float32([template[0][m.queryIdx].pt for m in matches])
    target = np.float32([scene[0][m.trainIdx].pt for m in matches])
    H, mask = cv2.findHomography(source, target, cv2.RANSAC, 5.0)
    return (None, 0) if H is None else (H, int(mask.sum()))


def warp(H: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Map (N, 2) points.

    Parameters
    ----------
    H : ndarray, shape (3, 3)
    points : ndarray, shape (N, 2)

    Returns
    -------
    ndarray, shape (N, 2), float64
    """
    return cv2.perspectiveTransform(points.reshape(-1, 1, 2).astype(np.float64), H).reshape(-1, 2)


def resized_points(
    points: NDArray[np.float64], before: Sequence[int], after: Sequence[int]
) -> NDArray[np.float64]:
    """Move points along when their picture is resized; pixel centres stay at integers.

    Parameters
    ----------
    points : ndarray, shape (N, 2)
    before, after : (width, height)

    Returns
    -------
    ndarray, shape (N, 2), float64
    """
    scale = np.array(after) / np.array(before)
    return (points + 0.5) * scale - 0.5


def iou(a: NDArray[np.float64], b: NDArray[np.float64], size: Sequence[int]) -> float:
    """Return the overlap of two polygons within the frame: intersection over union.

    Parameters
    ----------
    a, b : ndarray, shape (N, 2)
    size : (width, height)

    Returns
    -------
    float
    """
    masks = []
    for polygon in (a, b):
        mask = np.zeros((size[1], size[0]), np.uint8)
        # A degenerate homography throws points far away; fillPoly counts in 32 bits.
        corners = np.rint(np.clip(polygon, -5000, 5000)).astype(np.int32)
        masks.append(cv2.fillPoly(mask, [corners], 1))
    union = np.count_nonzero(masks[0] | masks[1])
    return np.count_nonzero(masks[0] & masks[1]) / union if union else 0.0


def exists(*names: str) -> bool:
    """Say whether all these files are in images/.

    Parameters
    ----------
    *names : str

    Returns
    -------
    bool
    """
    return all((images.folder() / name).is_file() for name in names)


def localised(
    template: NDArray[np.uint8],
    scene: NDArray[np.uint8],
    points: NDArray[np.float64],
    true: NDArray[np.float64],
) -> str:
    """Return the columns "matches | inliers | error" of a template in a scene.

    Parameters
    ----------
    template, scene : ndarray, shape (H, W, 3), uint8
        BGR.
    points, true : ndarray, shape (4, 2)
        Corners in the template, and where they are in the scene.

    Returns
    -------
    str
    """
    a, b = features(template), features(scene)
    matches = match(a, b)
    H, inliers = fit(a, b, matches[:100])
    if H is None:
        return f"{len(matches)} | no homography |  "
    error = np.linalg.norm(warp(H, points) - true, axis=1)
    return f"{len(matches)} | {inliers} | {np.median(error):.1f} / {error.max():.1f}"


def box_scene(name: str) -> str:
    """Measure one scene of the box; see `localised`.

    Parameters
    ----------
    name : str

    Returns
    -------
    str
    """
    template, box = images.load("box.png"), images.truth(name)["objects"]["box"]
    h, w = template.shape[:2]
    outline = np.array([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]], dtype=np.float64)
    return localised(template, images.load(name), outline, np.array(box["corners"]))


def mug_scene() -> str:
    """Measure the mug on the shelf at the exercise's sizes; see `localised`.

    Returns
    -------
    str
    """
    pictures, corners = [], []
    for name, size in (("ROS.png", (400, 600)), ("ROS2.png", (600, 400))):
        record = images.truth(name)
        pictures.append(images.resize(images.load(name), width=size[0], height=size[1]))
        printed = np.array(record["objects"]["mug"]["print_corners"])
        corners.append(resized_points(printed, record["size"], size))
    return localised(*pictures, *corners)


def stills() -> list[str]:
    """Measure every still picture.

    Returns
    -------
    list of str
        Lines of a Markdown table.
    """
    heads = (
        "Picture", "Size", "Visible", "ORB keypoints", "Matches", "Inliers of the best 100",
        "Corner error, px (median / largest)",
    )  # fmt: skip
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for name in images.names():
        if not name.endswith((".png", ".jpg")):
            continue
        image = images.load(name)
        columns, visible = " | | ", ""
        if name.startswith("box_in_scene"):
            columns = box_scene(name)
            visible = f"{images.truth(name)['objects']['box']['visible']:.0%}"
        elif name == "ROS2.png" and exists("ROS.png", "truth/ROS.json", "truth/ROS2.json"):
            columns = mug_scene()
        height, width = image.shape[:2]
        # ROS.png and ROS2.png are matched at the exercise's sizes, so count there too.
        sizes = {"ROS.png": (400, 600), "ROS2.png": (600, 400)}
        if name in sizes:
            image = images.resize(image, width=sizes[name][0], height=sizes[name][1])
        count = len(features(image)[0])
        lines.append(f"| `{name}` | {width}×{height} | {visible} | {count} | {columns} |")
    return lines


def flight_rates(name: str, template: NDArray[np.uint8], silhouette: NDArray[np.float64]) -> str:
    """Measure one flight: the share of frames in which each match count finds the well.

    Parameters
    ----------
    name : str
        Such as "flight.bag".
    template : ndarray, shape (H, W, 3), uint8
        BGR.
    silhouette : ndarray, shape (N, 2)
        Of the well in the template.

    Returns
    -------
    str
        A line of a Markdown table.
    """
    found, frames = dict.fromkeys(COUNTS, 0), 0
    wanted = features(template)
    with open_camera(images.path(name)) as source:
        for frame in source:
            well = frame.truth["well"]
            if well["visible"] < WHOLE:
                continue
            frames += 1
            seen = features(frame.image)
            matches = match(wanted, seen)
            true = np.array(well["polygon"], dtype=np.float64)
            for count in COUNTS:
                H, _ = fit(wanted, seen, matches[:count])
                size = frame.image.shape[1::-1]
                found[count] += H is not None and iou(warp(H, silhouette), true, size) > FOUND_IOU
    rates = " | ".join(f"{found[count] / max(frames, 1):.0%}" for count in COUNTS)
    return f"| `{name}` | {frames} | {rates} |"


def flights() -> list[str]:
    """Measure every flight with the template cut from flight.bag.

    Returns
    -------
    list of str
        Lines of a Markdown table; none while there is no flight.
    """
    if not exists("flight.bag", "truth/flight.json"):
        return []
    record = images.truth("flight.bag")
    x, y, w, h = record["template"]["rect"]
    with open_camera(images.path("flight.bag")) as source:
        frame = next(islice(source, record["template"]["frame"], None))
    template = np.ascontiguousarray(frame.image[y : y + h, x : x + w])
    silhouette = np.array(frame.truth["well"]["polygon"], dtype=np.float64) - (x, y)
    heads = " | ".join("all" if count is None else str(count) for count in COUNTS)
    lines = [f"| Flight | Frames | {heads} |", "|---" * (2 + len(COUNTS)) + "|"]
    names = [
        name
        for name in ("flight.bag", "heldout/flight_a.bag", "heldout/flight_b.bag")
        if exists(name)
    ]
    return lines + [flight_rates(name, template, silhouette) for name in names]


def main() -> None:
    """Print both tables; with `--write`, put them into images/README.md."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--write", action="store_true", help="replace them in images/README.md")
    write = parser.parse_args().write
    text = (
        f"Measured with OpenCV {cv2.__version__}.\n\n"
        + "\n".join(stills())
        + "\n\nFrames in which the well is found (the template's silhouette, mapped, overlaps the "
        f"true one by more than {FOUND_IOU}), by the number of best matches used. Only frames that "
        "show the whole well count.\n\n" + "\n".join(flights()) + "\n"
    )
    print(text)
    if write:
        before, rest = README.read_text(encoding="utf-8").split(BEGIN)
        after = rest.split(END)[1]
        README.write_text(before + BEGIN + "\n" + text + "\n" + END + after, encoding="utf-8")


if __name__ == "__main__":
    main()
