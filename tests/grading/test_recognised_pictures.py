"""What a notebook drew: a frame of the flight, drawn on or not, and a plot."""

from __future__ import annotations

import io

import cv2
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.patches import ConnectionPatch

from course_lib import images
from course_lib.drawing import draw_keypoints
from course_lib.grading.crops import judge_crop
from course_lib.grading.drawn import lines_cross, sightings
from course_lib.grading.plots import shows_plot
from course_lib.grading.published_flight import frame, frames_shown, photo_boxes, silhouette

COUNTS = np.arange(4, 1001, 18)


def outlined(number, thickness=3):
    picture = frame(number).copy()
    (left, top), (right, bottom) = (
        np.int32(f(silhouette(number), axis=0)) for f in (np.min, np.max)
    )
    return cv2.rectangle(
        picture,
        tuple(map(int, (left, top))),
        tuple(map(int, (right, bottom))),
        (0, 0, 255),
        thickness,
    )


def drawn(draw, axes=1):
    figure, places = plt.subplots(1, axes, figsize=(4 * axes, 3))
    for place, what in zip(np.atleast_1d(places), draw, strict=True):
        what(place)
    memory = io.BytesIO()
    figure.savefig(memory, bbox_inches="tight", dpi=72)
    plt.close(figure)
    return cv2.imdecode(np.frombuffer(memory.getvalue(), np.uint8), cv2.IMREAD_COLOR)


def image(picture):
    return lambda axes: axes.imshow(picture[..., ::-1])


def curve(axes):
    axes.plot(COUNTS, np.sqrt(COUNTS))


PICTURES = {
    "as it is": lambda make: make(61),
    "half the size": lambda make: cv2.resize(make(87), (320, 240), interpolation=cv2.INTER_AREA),
    "axes": lambda make: drawn([image(make(33))]),
    "two frames and a plot": lambda make: drawn([image(make(20)), curve, image(make(75))], 3),
    "side by side": lambda make: np.hstack([make(10), make(90)]),
}


@pytest.mark.parametrize("name", PICTURES)
def test_a_frame_is_told_from_one_that_was_drawn_on(name):
    plain = frames_shown(PICTURES[name](frame))
    marked = frames_shown(PICTURES[name](outlined))
    assert len(plain) == len(marked) > 0
    assert max(one.drawn for one in plain) < 0.0008
    assert min(one.drawn for one in marked) > 0.003
    assert min(one.about_well for one in marked) > 0.8


def test_a_grid_is_no_outline():
    def grid(axes):
        axes.imshow(frame(60)[..., ::-1])
        axes.set(xticks=range(0, 640, 50), yticks=range(0, 480, 50))
        axes.grid()

    (shown,) = frames_shown(drawn([grid]))
    assert shown.drawn > 0.003
    assert shown.about_well < 0.5


def test_a_thin_outline_shows():
    assert frames_shown(outlined(70, thickness=1))[0].drawn > 0.002


def test_other_pictures_are_no_frames():
    noise = np.random.default_rng(0).integers(0, 255, (480, 640, 3), np.uint8)
    assert frames_shown(noise) == []
    assert frames_shown(drawn([curve])) == []


@pytest.mark.parametrize(
    "draw",
    [
        curve,
        lambda axes: axes.scatter(COUNTS, COUNTS % 7, s=4),
        lambda axes: axes.bar(COUNTS, COUNTS % 7, width=15),
        lambda axes: (axes.plot(COUNTS, COUNTS % 7, "."), axes.axis("off")),
        lambda axes: axes.imshow(np.outer(np.arange(6), np.sqrt(COUNTS)), aspect="auto"),
    ],
    ids=["curve", "points", "bars", "no axes", "map"],
)
def test_a_plot_is_one_in_any_style(draw):
    assert shows_plot(drawn([draw]))
    assert shows_plot(drawn([image(frame(60)), draw], 2))


def test_a_photograph_is_no_plot():
    for picture in (frame(60), drawn([image(outlined(40))]), drawn([image(frame(9))] * 3, 3)):
        assert not shows_plot(picture)


@pytest.mark.parametrize(
    ("crop", "least", "most", "said"),
    [
        (lambda f: f[116:381, 194:437], 1, 1, None),
        (lambda f: f[90:400, 170:460], 1, 1, None),
        (lambda f: f[180:330, 250:400], 1, 1, None),
        (lambda f: f[60:440, 120:520], 0.9, 1, None),
        (lambda f: f, 0, 0.05, "cut closer"),
        (lambda f: f[194:437, 116:381], 0, 0.6, "swapped"),
        (lambda f: f[0:100, 0:100], 0, 0, "where is it cut off"),
        (lambda f: f[116:381, 194:437, ::-1], 0, 0, "RGB"),
        (lambda f: f[116:381, 194:437, 0], 0, 0, "in colour"),
        (lambda f: cv2.resize(f[116:381, 194:437], None, fx=2, fy=2), 0, 0, "not resized"),
        (lambda f: f[500:, :], 0, 0, "empty"),
        (lambda _: None, 0, 0, "part of the frame"),
    ],
)
def test_a_crop_is_judged_by_what_it_holds(crop, least, most, said):
    judged = judge_crop(crop(frame(60)), frame(60), silhouette(60))
    assert least <= judged.credit <= most
    assert (judged.message is None) == (said is None and judged.credit == 1)
    assert said is None or said in judged.message


@pytest.mark.parametrize("show", [lambda p: p, lambda p: drawn([lambda a: a.imshow(p[..., ::-1])])])
def test_large_keypoints_hide_no_picture(show):
    mug = images.resize(images.load("ROS.png"), 400, 600)
    keypoints = cv2.ORB_create(1000).detect(mug)
    (seen,) = sightings(show(draw_keypoints(mug, keypoints)), mug)
    assert seen.drawn > 0.1
    peppers = images.resize(images.load("peppers.png"), 400, 600)
    assert sightings(show(draw_keypoints(peppers, keypoints)), mug) == []


@pytest.mark.parametrize("beside", [outlined(44), outlined(60)])
def test_keypoints_beside_a_frame_are_seen(beside):
    """The frame shows the well, too, and more clearly."""
    crop = frame(60)[90:400, 165:465].copy()
    keypoints = cv2.SIFT_create(contrastThreshold=0.03).detect(crop)
    figure = drawn(
        [image(cv2.drawKeypoints(crop, keypoints, None, (0, 255, 255))), image(beside)], 2
    )
    boxes = photo_boxes(figure)
    (shown,) = frames_shown(figure)
    alone = [s for s in sightings(figure, crop, places=boxes) if s.box[2] < shown.box[0]]
    assert [seen.drawn > 0.05 for seen in alone] == [True]
    other = drawn([image(cv2.drawKeypoints(frame(9)[90:400, 0:300], keypoints, None))], 1)
    assert sightings(other, crop, places=photo_boxes(other)) == []


@pytest.mark.parametrize("style", ["default", "dark_background", "ggplot"])
@pytest.mark.parametrize("shape", [(1, 2), (2, 1)])
@pytest.mark.parametrize("n_lines", [0, 20])
def test_lines_between_two_axes_are_told_from_their_numbers(style, shape, n_lines):
    mug, scene = images.load("ROS.png"), images.load("ROS2.png")
    with plt.style.context(style):
        figure, (left, right) = plt.subplots(*shape, figsize=(8, 6))
        for axes, picture in ((left, mug), (right, scene)):
            axes.imshow(picture[..., ::-1])
        rng = np.random.default_rng(0)
        for here, there in rng.uniform(0, 1, (n_lines, 2, 2)):
            ends = (here * mug.shape[1::-1], there * scene.shape[1::-1])
            figure.add_artist(
                ConnectionPatch(*ends, "data", "data", axesA=left, axesB=right, color="lime")
            )
        memory = io.BytesIO()
        figure.savefig(memory, dpi=72)
        plt.close(figure)
    shown = cv2.imdecode(np.frombuffer(memory.getvalue(), np.uint8), cv2.IMREAD_COLOR)
    places = photo_boxes(shown)
    one, other = (sightings(shown, each, places=places)[0].box for each in (mug, scene))
    assert lines_cross(shown, one, other) == (n_lines > 0)


@pytest.mark.parametrize("shape", [(1, 3), (3, 1)])
def test_a_picture_between_two_is_no_lines(shape):
    mug, scene = images.load("ROS.png"), images.load("ROS2.png")
    figure, places = plt.subplots(*shape, figsize=(6 * shape[1], 5 * shape[0]))
    between = images.load("peppers.png")
    for axes, picture in zip(places, (mug, between, scene), strict=True):
        axes.imshow(picture[..., ::-1])
    memory = io.BytesIO()
    figure.savefig(memory, dpi=72)
    plt.close(figure)
    shown = cv2.imdecode(np.frombuffer(memory.getvalue(), np.uint8), cv2.IMREAD_COLOR)
    one, other = (sightings(shown, each, places=photo_boxes(shown))[0].box for each in (mug, scene))
    assert not lines_cross(shown, one, other)
