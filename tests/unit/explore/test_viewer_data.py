"""What the viewers hand to the browser agrees with OpenCV, and reads well without a browser."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable
from types import SimpleNamespace

import cv2
import ipywidgets
import numpy as np
import pytest

from course_lib import explore
from course_lib.explore._magnifier import verdict
from course_lib.segment_test import longest_arc


def textured(seed: int, shape: tuple[int, int] = (120, 160)) -> np.ndarray:
    rng = np.random.default_rng(seed)
    coarse = rng.integers(0, 256, (shape[0] // 8, shape[1] // 8, 3), dtype=np.uint8)
    picture = cv2.resize(coarse, shape[::-1], interpolation=cv2.INTER_CUBIC)
    return np.clip(picture + rng.normal(0, 6, picture.shape), 0, 255).astype(np.uint8)


PICTURE = textured(1, (360, 480))
TEMPLATE = PICTURE[60:300, 100:400].copy()
SCENE = np.ascontiguousarray(np.roll(PICTURE, (20, -30), axis=(0, 1)))
FRAMES = [
    SimpleNamespace(
        image=np.ascontiguousarray(np.roll(PICTURE, shift, axis=1)),
        truth={
            "well": {
                "polygon": [
                    [x + shift, y] for x, y in ((100, 60), (100, 299), (399, 299), (399, 60))
                ],
                "visible": 1.0,
            }
        },
    )
    for shift in (0, 10, 20)
]
OUTLINE = [[0, 0], [0, 239], [299, 239], [299, 0]]

VIEWERS: dict[str, Callable[[], explore._base.Viewer]] = {
    "fast": lambda: explore.fast(PICTURE),
    "fast_magnifier": lambda: explore.fast_magnifier(PICTURE),
    "brief_pairs": lambda: explore.brief_pairs(PICTURE),
    "matches": lambda: explore.matches(TEMPLATE, SCENE),
    "ransac": lambda: explore.ransac(TEMPLATE, SCENE),
    "flight": lambda: explore.flight(FRAMES, TEMPLATE, outline=OUTLINE, every=1),
}


def canvas_of(viewer: ipywidgets.VBox) -> ipywidgets.Widget:
    return viewer.children[-1]


def test_magnifier_agrees_with_opencv_at_every_pixel() -> None:
    grey = cv2.cvtColor(textured(3, (48, 48)), cv2.COLOR_BGR2GRAY)
    corners = {k.pt for k in cv2.FastFeatureDetector_create(15, False).detect(grey)}
    for y in range(3, 45):
        for x in range(3, 45):
            assert ("a corner" in verdict(grey, x, y, 15)) == ((float(x), float(y)) in corners)


def test_arc_runs_over_the_seam() -> None:
    states = [1] * 5 + [0] * 6 + [1] * 5
    assert longest_arc(states) == (10, 11, 1)


@pytest.mark.parametrize("name", VIEWERS)
def test_viewer_carries_a_small_still_and_its_words(name: str) -> None:
    viewer = VIEWERS[name]()
    data, metadata = viewer._repr_mimebundle_()
    png = base64.b64decode(data["image/png"])
    assert cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR) is not None
    assert len(png) <= 100_000
    assert metadata["image/png"]["alt"] == data["text/plain"] == viewer.alt == canvas_of(viewer).alt
    assert "application/vnd.jupyter.widget-view+json" in data


@pytest.mark.parametrize("name", VIEWERS)
def test_viewer_says_the_same_twice(name: str) -> None:
    assert VIEWERS[name]().alt == VIEWERS[name]().alt


@pytest.mark.parametrize(
    "call",
    [
        lambda: explore.fast(None),  # what cv2.imread gives for a missing file
        lambda: explore.fast_magnifier(PICTURE[:10, :10]),
        lambda: explore.brief_pairs(PICTURE, PICTURE[:-1]),
        lambda: explore.matches(TEMPLATE, np.zeros_like(SCENE)),
        lambda: explore.ransac(TEMPLATE.astype(float), SCENE),
        lambda: explore.flight([], TEMPLATE),
    ],
)
def test_viewer_refuses_what_it_cannot_show(call: Callable[[], object]) -> None:
    with pytest.raises((TypeError, ValueError), match=r"must|empty|matches"):
        call()


def test_match_outline_follows_a_known_shift() -> None:
    canvas = canvas_of(explore.matches(TEMPLATE, SCENE))
    outlines = np.frombuffer(canvas.outlines, "<f4").reshape(-1, 4, 2)
    shift = json.loads(canvas.texts)["shift"]
    truth = np.array([[70, 80], [70, 319], [369, 319], [369, 80]]) + [shift, 0]
    assert np.abs(outlines[96] - truth).max() < 2  # slider at 100 matches


def test_flight_measures_the_error_against_truth() -> None:
    canvas = canvas_of(explore.flight(FRAMES, TEMPLATE, outline=OUTLINE, every=1))
    errors = np.frombuffer(canvas.errors, "<f4").reshape(3, -1)
    assert np.nanmax(errors[:, -1]) < 1.5


def test_slider_is_linked_in_the_browser() -> None:
    viewer = explore.fast(PICTURE)
    live = list(ipywidgets.widgets.widget._instances.values())
    links = [w for w in live if isinstance(w, ipywidgets.widgets.widget_link.Link)]
    slider, canvas = viewer.children[0], canvas_of(viewer)
    assert any(w.source == (slider, "value") and w.target == (canvas, "threshold") for w in links)
