"""Each usual mistake is recognised over many views; a right answer never is."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from course_lib.grading.geometry import corner_error, diagnose, recognise
from course_lib.grading.mistake_texts import MESSAGES
from course_lib.homography import project
from course_lib.scenes.poses import random_homography

TEMPLATE, SCENE = (600, 400, 3), (400, 600, 3)
RECTANGLE = np.array([[0, 0], [0, 599], [399, 599], [399, 0]], float)
FRAME = np.array([[0, 0], [0, 399], [599, 399], [599, 0]], float)
KINDS = ("plain", "rotation", "scale", "tilt")


def mapped(H, points):
    return cv2.perspectiveTransform(points.reshape(-1, 1, 2).astype(float), H).reshape(-1, 2)


def in_order(*order):
    return lambda H: mapped(H, RECTANGLE)[list(order)]


def upright(H):
    true = mapped(H, RECTANGLE)
    (x0, y0), (x1, y1) = true.min(axis=0), true.max(axis=0)
    return np.array([[x0, y0], [x0, y1], [x1, y1], [x1, y0]])


# What a student's code would return, given the homography it found.
MISTAKES = {
    "inverse": [lambda H: mapped(np.linalg.inv(H), RECTANGLE)],
    "order": [
        in_order(0, 3, 2, 1),  # clockwise
        in_order(3, 0, 1, 2),
        in_order(2, 3, 0, 1),
        in_order(1, 2, 3, 0),
        in_order(3, 2, 1, 0),  # mirrored
        in_order(0, 3, 1, 2),  # row by row
        in_order(0, 1, 3, 2),
    ],
    "xy": [lambda H: mapped(H, RECTANGLE)[:, ::-1]],
    "wh": [lambda H: mapped(H, np.array([[0, 0], [0, 399], [599, 399], [599, 0]]))],
    "template size": [
        lambda H: mapped(H, RECTANGLE * 1.5),
        lambda H: mapped(H, RECTANGLE * 0.5),
    ],
    "scene": [lambda _: FRAME, lambda _: FRAME[[0, 3, 2, 1]]],
    "template": [lambda _: RECTANGLE, lambda _: RECTANGLE[[0, 3, 2, 1]]],
    "unit": [lambda H: mapped(H, RECTANGLE) / (600, 400)],
    "resized": [lambda H: mapped(H, RECTANGLE) * 0.5, lambda H: mapped(H, RECTANGLE) * 1.5],
    "resized swapped": [lambda H: mapped(H, RECTANGLE) * (400 / 600, 600 / 400)],
    "beside": [lambda H: mapped(H, RECTANGLE) + (400, 0)],
    "shifted": [lambda H: mapped(H, RECTANGLE) + (90, -70)],
}  # fmt: skip
CASES = [(name, number) for name, each in MISTAKES.items() for number in range(len(each))]


@st.composite
def views(draw, kinds=KINDS):
    """A homography as scenes have it, and one as an honest estimate of it."""
    kind = draw(st.sampled_from(kinds))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    H = random_homography(kind, rng)
    noise = rng.normal(0, 1.2, (4, 2))
    true = mapped(H, RECTANGLE)
    estimate = cv2.getPerspectiveTransform(
        RECTANGLE.astype(np.float32), (true + noise).astype(np.float32)
    )
    return H, estimate


@pytest.mark.parametrize(("name", "number"), CASES)
@settings(max_examples=60, deadline=None)
@given(views())
def test_mistake_is_named(name, number, view):
    H, estimate = view
    true = mapped(H, RECTANGLE)
    wrong = MISTAKES[name][number](estimate)
    # A mistake that hardly shows, such as the box around an upright mug, is none.
    assume(corner_error(wrong, true) > 0.15 * np.linalg.norm(np.ptp(true, axis=0)))
    assert recognise(wrong, true, TEMPLATE, SCENE) == name
    text = diagnose(wrong, true, TEMPLATE, SCENE)
    assert text == MESSAGES[name].format(thing="mug")


@settings(max_examples=60, deadline=None)
@given(views(kinds=("rotation",)))
def test_upright_box_is_named(view):
    H, estimate = view
    true, wrong = mapped(H, RECTANGLE), upright(estimate)
    # A box around a mug that hardly leans is no mistake that one could see.
    assume(corner_error(wrong, true) > 0.15 * np.linalg.norm(np.ptp(true, axis=0)))
    assert recognise(wrong, true, TEMPLATE, SCENE) in {"upright", "order"}
    leans = min(corner_error(np.roll(wrong, k, axis=0), true) for k in range(4))
    if leans > 0.1 * np.linalg.norm(np.ptp(true, axis=0)):
        assert recognise(wrong, true, TEMPLATE, SCENE) == "upright"


@settings(max_examples=60, deadline=None)
@given(st.floats(3e-4, 9e-4), st.floats(-3e-4, 3e-4), st.floats(0, 1.5))
def test_forgotten_division_is_named(down, across, turn):
    cosine, sine = 0.7 * math.cos(turn), 0.7 * math.sin(turn)
    H = np.array([[cosine, -sine, 300], [sine, cosine, 40], [across, down, 1]])
    true = mapped(H, RECTANGLE)
    wrong = (np.column_stack([RECTANGLE, np.ones(4)]) @ H.T)[:, :2]
    assert recognise(wrong, true, TEMPLATE, SCENE) == "depth"


@settings(max_examples=300, deadline=None)
@given(views(), st.booleans())
def test_right_answer_is_never_named(view, rounded):
    H, estimate = view
    found = mapped(estimate, RECTANGLE)
    if rounded:
        found = np.rint(found).astype(int)
    assert recognise(found, mapped(H, RECTANGLE), TEMPLATE, SCENE) is None


@settings(max_examples=100, deadline=None)
@given(views(), st.integers(0, 2**32 - 1), st.floats(0.05, 0.12))
def test_rough_answer_is_near(view, seed, share):
    true = mapped(view[0], RECTANGLE)
    push = np.random.default_rng(seed).normal(size=(4, 2))
    push -= push.mean(axis=0)
    push *= share * np.linalg.norm(np.ptp(true, axis=0)) * 2 / np.linalg.norm(push)
    named = recognise(true + push, true, TEMPLATE, SCENE)
    assert named == "near"


@settings(max_examples=200, deadline=None)
@given(views(), st.integers(0, 2**32 - 1))
def test_garbage_is_far_or_folded(view, seed):
    """Homographies of random matches; a few of many look like something by chance."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(0, 1, (4, 2)).astype(np.float32) * np.float32((400, 600))
    there = rng.uniform(0, 1, (4, 2)).astype(np.float32) * np.float32((600, 400))
    wrong = project(cv2.getPerspectiveTransform(points, there), RECTANGLE)
    true = mapped(view[0], RECTANGLE)
    assume(corner_error(wrong, true) > 0.5 * np.linalg.norm(np.ptp(true, axis=0)))
    named = recognise(wrong, true, TEMPLATE, SCENE)
    assert named in {"far", "folded", "collapsed", "within"}


TRUE = mapped(random_homography("plain", np.random.default_rng(1)), RECTANGLE)
SHAPES = [
    (None, "none"),
    (TRUE.reshape(4, 1, 2), "(4, 1, 2)"),
    (TRUE.reshape(1, 4, 2), "(4, 1, 2)"),
    (TRUE.T, "transposed"),
    (TRUE.ravel(), "flat"),
    (np.eye(3), "homography"),
    ([10, 20, 30, 40], "box"),
    (TRUE[:3], "three"),
    (TRUE.mean(axis=0), "one point"),
    ((TRUE, 57), "with more"),
    ([TRUE, None], "with more"),
    (TRUE[[2, 3, 0, 1]] * 0.4 + TRUE.mean(axis=0) * 0.6, "within"),
    (np.vstack([TRUE, TRUE[:1]]), "five"),
    (np.zeros((57, 2)), "matches"),
    (np.zeros((57, 1, 2)), "matches"),
    ("corners", "kind"),
    ([[1, 2], [3]], "kind"),
    ({"corners": 1}, "kind"),
    (np.array(5), "kind"),
    (TRUE.astype(complex), "kind"),
    (np.where(TRUE.mean() < TRUE, np.nan, TRUE), "nan"),
    (np.full((4, 2), np.inf), "nan"),
    (np.full((4, 2), 1e300), "far"),
    (np.full((4, 2), 200.0), "collapsed"),
    (TRUE[[0, 2, 1, 3]] + (150, 90) * np.array([[1], [-1], [1], [-1]]), "folded"),
]


@pytest.mark.parametrize(("found", "name"), SHAPES, ids=[name for _, name in SHAPES])
def test_shapes_are_named(found, name):
    assert recognise(found, TRUE, TEMPLATE, SCENE) == name


def test_absence():
    assert recognise(None, None, TEMPLATE, SCENE) is None
    assert recognise(TRUE, None, TEMPLATE, SCENE) == "absent"
    assert "the well is not in this scene" in diagnose(TRUE, None, TEMPLATE, SCENE, thing="well")


@pytest.mark.parametrize(
    "found", [[], (), False, "not found", np.zeros((4, 2)), np.full(4, -1), 0], ids=str
)
def test_what_stands_for_nothing_is_not_taken_for_an_outline(found):
    assert recognise(found, None, TEMPLATE, SCENE) == "nothing"


@pytest.mark.parametrize("found", [TRUE, TRUE[:, None], np.full((4, 2), np.nan), {"corners": 1}])
def test_what_does_not_stand_for_nothing(found):
    assert recognise(found, None, TEMPLATE, SCENE) == "absent"


def test_corners_as_uint8_wrap_round():
    assert TRUE.max() > 256
    assert recognise(TRUE.astype(np.int64) % 256, TRUE, TEMPLATE, SCENE) == "wrapped"


def test_every_text_can_be_filled_and_holds_no_number_of_the_scene():
    for name, text in MESSAGES.items():
        filled = text.format(thing="mug")
        assert "{" not in filled, name
        assert filled.endswith((".", "?")), name
        numbers = {word for word in filled.replace(",", " ").split() if word.isdigit()}
        assert all(math.isclose(int(word), 0, abs_tol=9) for word in numbers), name


def test_scene_outline_where_sizes_differ():
    template, scene = (300, 400, 3), (480, 640, 3)
    H = np.array([[0.9, -0.2, 150], [0.2, 0.9, 80], [0.0001, 0, 1]])
    corners = np.array([[0, 0], [0, 299], [399, 299], [399, 0]], float)
    frame = np.array([[0, 0], [0, 479], [639, 479], [639, 0]], float)
    found = mapped(H, frame)
    assert recognise(found, mapped(H, corners), template, scene) == "scene outline"
