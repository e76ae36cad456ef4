"""What the browser works out is what OpenCV works out, with no kernel left to ask."""

from __future__ import annotations

import re
import textwrap
from typing import Any

import cv2
import nbformat
import numpy as np
import pytest
from conftest import Lab, run_all, watch_console
from nbformat.v4 import new_code_cell, new_notebook
from playwright.sync_api import Locator, Page, expect

from course_lib.brief import sampling_pairs

# Runs here and, as text, in the notebook, so that both have the same picture.
SETUP = textwrap.dedent(
    """
    import cv2
    import numpy as np
    from course_lib import explore, quiz
    rng = np.random.default_rng(7)
    coarse = rng.integers(0, 256, (30, 40, 3), dtype=np.uint8)
    picture = cv2.resize(coarse, (320, 240), interpolation=cv2.INTER_CUBIC)
    picture = np.clip(picture + rng.normal(0, 6, picture.shape), 0, 255).astype(np.uint8)
    scene = np.ascontiguousarray(np.roll(picture, (12, -20), axis=(0, 1)))
    template = picture[40:200, 60:260].copy()
    """
)
CELLS = {
    "fast": "explore.fast(picture, max_threshold=120)",
    "fast_magnifier": "explore.fast_magnifier(picture)",
    "brief_pairs": "explore.brief_pairs(picture, points=[(60, 60), (200, 150)])",
    "matches": "explore.matches(template, scene, match_count=40)",
    "ransac": "explore.ransac(template, scene, match_count=60)",
    "choose": 'quiz.choose("Which?", ["one", "two"], answer="two", because={"one": "It is odd."})',
    "number": 'quiz.number("How far?", 10.7, tolerance=0.05, unit="m", '
    'because={10.7: "Measured.", 1070: "That is in centimetres."})',
}
DISTANCE = re.compile(r"Hamming distance (\d+) of (\d+)")


@pytest.fixture(scope="module")
def ours() -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(compile(SETUP, "setup", "exec"), names)  # noqa: S102
    names["grey"] = cv2.cvtColor(names["picture"], cv2.COLOR_BGR2GRAY)
    return names


@pytest.fixture(scope="module")
def orphan(browser: Any, lab: Lab) -> Any:
    """A notebook with every viewer, run once; then its kernel is shut down."""
    notebook = new_notebook(cells=[new_code_cell(s) for s in (SETUP, *CELLS.values())])
    notebook.metadata.kernelspec = {"name": "python3", "display_name": "Python 3"}
    nbformat.write(notebook, lab.root / "viewers.ipynb")
    context = browser.new_context(viewport={"width": 1300, "height": 3600})
    page = context.new_page()
    errors = watch_console(page)
    run_all(page, lab, "viewers.ipynb")
    expect(page.locator(".fm-viewer .fm-readout")).to_have_count(5)
    expect(page.locator(".fm-quiz")).to_have_count(2)
    page.evaluate("() => window.jupyterapp.shell.currentWidget.context.sessionContext.shutdown()")
    page.wait_for_function(
        "() => window.jupyterapp.shell.currentWidget.context.sessionContext.session === null"
    )
    yield page
    context.close()
    # ipywidgets deplores each value that it cannot tell the kernel; the viewers go on.
    assert [e for e in errors if "Could not send widget sync message" not in e] == []


def cell(page: Page, name: str) -> Locator:
    return page.locator(".jp-CodeCell").nth(1 + list(CELLS).index(name))


def readout(page: Page, name: str) -> str:
    page.evaluate("() => new Promise((d) => requestAnimationFrame(() => requestAnimationFrame(d)))")
    return cell(page, name).locator(".fm-readout").inner_text()


def press(page: Page, name: str, key: str, times: int, slider: int = 0) -> None:
    cell(page, name).locator(".noUi-handle").nth(slider).focus()
    for _ in range(times):
        page.keyboard.press(key)


def test_fast_counts_are_opencvs_at_each_threshold(orphan: Page, ours: dict[str, Any]) -> None:
    press(orphan, "fast", "Home", 1)
    switch = cell(orphan, "fast").locator("input[type=checkbox]")
    for threshold in range(1, 60, 3):
        for nonmax in (True, False):
            switch.set_checked(nonmax)
            found = cv2.FastFeatureDetector_create(threshold, nonmax).detect(ours["grey"])
            how = "with" if nonmax else "without"
            expected = f"{len(found)} corners at threshold {threshold}, {how} "
            assert readout(orphan, "fast").startswith(expected)
        press(orphan, "fast", "ArrowRight", 3)


def test_magnifier_judges_each_pixel_as_opencv(orphan: Page, ours: dict[str, Any]) -> None:
    detector = cv2.FastFeatureDetector_create(20, nonmaxSuppression=False)
    corners = {tuple(map(int, k.pt)) for k in detector.detect(ours["grey"])}
    cell(orphan, "fast_magnifier").locator("canvas").focus()
    verdicts = set()
    for step in range(60):
        orphan.keyboard.press(("ArrowRight", "ArrowDown", "ArrowLeft")[step // 5 % 3])
        text = readout(orphan, "fast_magnifier")
        x, y = map(int, re.match(r"\((\d+), (\d+)\)", text).groups())
        assert ("CORNER" in text) == ((x, y) in corners), text
        verdicts.add("CORNER" in text)
    assert verdicts == {True, False}


def test_pointer_snaps_to_a_corner_and_a_click_holds_it(orphan: Page, ours: dict[str, Any]) -> None:
    canvas = cell(orphan, "fast_magnifier").locator("canvas")
    canvas.click(position={"x": 5, "y": 5})
    if "Held" in readout(orphan, "fast_magnifier"):
        canvas.click(position={"x": 5, "y": 5})
    detector = cv2.FastFeatureDetector_create(20, nonmaxSuppression=True)
    best = max(detector.detect(ours["grey"]), key=lambda k: k.response)
    x, y = (int(v) for v in best.pt)
    scale = 400 / 320
    near = {"x": (x + 0.5) * scale + 2, "y": (y + 0.5) * scale + 1}
    canvas.hover(position=near)
    assert readout(orphan, "fast_magnifier").startswith(f"({x}, {y}) ")
    canvas.click(position=near)
    canvas.hover(position={"x": 200, "y": 290})
    assert readout(orphan, "fast_magnifier").startswith(f"({x}, {y}) ")
    canvas.click(position=near)
    canvas.hover(position={"x": 200, "y": 290})
    assert not readout(orphan, "fast_magnifier").startswith(f"({x}, {y}) ")


def test_hamming_distance_is_the_descriptors(orphan: Page, ours: dict[str, Any]) -> None:
    press(orphan, "brief_pairs", "ArrowRight", 1, slider=1)  # point B
    choices = cell(orphan, "brief_pairs").locator("select")
    seen = set()
    for index, geometry in enumerate(("G I", "G II", "G III", "G IV", "G V")):
        choices.nth(0).select_option(index=index)
        for size in range(3):
            choices.nth(1).select_option(index=size)
            tests = 128 << size
            smooth = cv2.GaussianBlur(ours["grey"], (0, 0), 2.0)
            x1, y1, x2, y2 = sampling_pairs(geometry, 512, 31, seed=0)[:tests].T
            a, b = (
                smooth[y + y1, x + x1] < smooth[y + y2, x + x2] for x, y in ((60, 60), (200, 150))
            )
            found = DISTANCE.search(readout(orphan, "brief_pairs"))
            assert found
            assert [int(v) for v in found.groups()] == [np.count_nonzero(a != b), tests]
            seen.add(found.group(0))
    assert len(seen) > 10


@pytest.mark.parametrize("name", ["matches", "ransac"])
def test_match_readouts_follow_the_slider(orphan: Page, name: str) -> None:
    before = readout(orphan, name)
    assert "found" in before
    press(orphan, name, "ArrowRight", 3)
    assert readout(orphan, name).startswith("43 matches" if name == "matches" else "within 6.5")
    press(orphan, name, "ArrowLeft", 3)
    assert readout(orphan, name) == before


def test_wrong_option_says_why_and_may_be_mended(orphan: Page) -> None:
    question = cell(orphan, "choose").locator(".fm-quiz")
    verdict = question.locator("[aria-live]")
    question.get_by_label("one").check()
    assert verdict.inner_text() == "✗ Not yet. It is odd. Try again."
    orphan.keyboard.press("ArrowDown")  # a radio group answers the arrow keys
    assert verdict.inner_text().strip() == "✓ Right."


@pytest.mark.parametrize(
    ("typed", "verdict"),
    [
        ("10.7", "✓ Right. Measured."),
        ("10,7 m", "✓ Right. Measured."),
        (" 10.65", "✓ Right. Measured."),
        ("1070", "✗ Not yet. That is in centimetres. Try again."),
        ("3", "✗ Not yet. Your number is too small. Try again."),
        ("10.8", "✗ Not yet. Your number is too large. Try again."),
        ("many", "✗ Not yet. Please type a number. Try again."),
        ("−10.7", "✗ Not yet. Your number is too small. Try again."),
    ],
)
def test_numbers_are_judged_as_people_type_them(orphan: Page, typed: str, verdict: str) -> None:
    question = cell(orphan, "number").locator(".fm-quiz")
    question.get_by_label("How far?").fill(typed)
    orphan.keyboard.press("Enter")
    assert question.locator("[aria-live]").inner_text() == verdict
