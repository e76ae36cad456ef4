"""Every viewer of every notebook, in a real JupyterLab, answers keyboard and mouse."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from conftest import Lab, run_all, watch_console
from playwright.sync_api import Locator, Page, expect

ROOT = Path(__file__).resolve().parents[2]
LESSONS = sorted(p.name for p in (ROOT / "notebooks").glob("4_*.ipynb"))

# A cheap fingerprint of what a canvas shows.
HASH = """canvas => {
  const d = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  let h = 0;
  for (let i = 0; i < d.length; i += 4) h = (h * 31 + d[i] * 7 + d[i + 1] * 3 + d[i + 2]) | 0;
  return h;
}"""
CONTRAST = """element => {
  const parse = (c) => (c.match(/[\\d.]+/g) ?? []).map(Number);
  let back = element;
  while (back && (parse(getComputedStyle(back).backgroundColor)[3] ?? 1) === 0)
    back = back.parentElement;
  const light = (rgb) => {
    const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    const [r, g, b] = rgb.map((v) => linear(v / 255));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ink = light(parse(getComputedStyle(element).color).slice(0, 3));
  const paper = light(parse(getComputedStyle(back).backgroundColor).slice(0, 3));
  return (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05);
}"""


@pytest.fixture(scope="module", params=LESSONS)
def lesson(request: pytest.FixtureRequest, browser: Any, lab: Lab) -> Any:
    """One notebook, run once for all tests about it."""
    context = browser.new_context(viewport={"width": 1300, "height": 1100})
    page = context.new_page()
    page.course_errors = watch_console(page)
    run_all(page, lab, f"notebooks/{request.param}", seconds=90)
    reveal_all(page)
    yield page
    context.close()


def reveal_all(page: Page) -> None:
    """Scroll through the notebook, since JupyterLab draws only what is near the window."""
    page.evaluate(
        """async () => {
          const notebook = window.jupyterapp.shell.currentWidget.content;
          for (let i = 0; i < notebook.widgets.length; i++) {
            await notebook.scrollToItem(i);
            await new Promise((done) => setTimeout(done, 40));
          }
        }"""
    )
    page.wait_for_timeout(500)


def viewers(page: Page) -> list[Locator]:
    boxes = page.locator(".fm-box")
    return [boxes.nth(i) for i in range(boxes.count())]


def cell_height(viewer: Locator) -> float:
    return float(viewer.evaluate("e => e.closest('.jp-Cell').getBoundingClientRect().height"))


def settle(page: Page) -> None:
    page.evaluate("() => new Promise((d) => requestAnimationFrame(() => requestAnimationFrame(d)))")


def test_viewers_appear(lesson: Page) -> None:
    found = viewers(lesson)
    assert found
    for viewer in found:
        viewer.scroll_into_view_if_needed()
        expect(viewer.locator("canvas")).to_be_visible()
        assert viewer.locator("canvas").get_attribute("aria-label")
        expect(viewer.locator(".fm-readout")).not_to_be_empty()


def test_every_slider_answers_the_keyboard_without_moving_the_page(lesson: Page) -> None:
    for viewer in viewers(lesson):
        viewer.scroll_into_view_if_needed()
        canvas = viewer.locator("canvas")
        handles = viewer.locator(".noUi-handle")
        for i in range(handles.count()):
            before, height = canvas.evaluate(HASH), cell_height(viewer)
            readout = viewer.locator(".fm-readout").inner_text()
            handles.nth(i).focus()
            changed = False
            # Either end may be reached already, and one step may change no pixel.
            for key in ("ArrowRight", "ArrowRight", "ArrowLeft", "ArrowLeft", "ArrowLeft"):
                lesson.keyboard.press(key)
                settle(lesson)
                text = viewer.locator(".fm-readout").inner_text()
                changed = changed or canvas.evaluate(HASH) != before or text != readout
                assert cell_height(viewer) == height
            assert changed


def test_every_slider_answers_the_mouse(lesson: Page) -> None:
    for viewer in viewers(lesson):
        viewer.scroll_into_view_if_needed()
        sliders = viewer.locator(".noUi-target")
        for i in range(sliders.count()):
            sliders.nth(i).scroll_into_view_if_needed()
            box = sliders.nth(i).bounding_box()
            assert box
            texts = set()
            for share in (0.1, 0.5, 0.9):
                lesson.mouse.click(box["x"] + share * box["width"], box["y"] + box["height"] / 2)
                lesson.wait_for_timeout(400)  # the slider glides to a click and is deaf meanwhile
                texts.add(viewer.locator(".fm-readout").inner_text())
            assert len(texts) >= 2


def test_every_choice_changes_the_viewer(lesson: Page) -> None:
    for viewer in viewers(lesson):
        viewer.scroll_into_view_if_needed()
        for kind in ("select", "input[type=checkbox]"):
            controls = viewer.locator(kind)
            for i in range(controls.count()):
                control = controls.nth(i)
                before = viewer.locator(".fm-readout").inner_text()
                if kind == "select":
                    chosen = int(control.evaluate("e => e.selectedIndex"))
                    control.select_option(index=0 if chosen else 1)
                else:
                    control.click()
                settle(lesson)
                assert viewer.locator(".fm-readout").inner_text() != before


def test_magnifier_follows_pointer_and_arrow_keys(lesson: Page) -> None:
    canvas = lesson.locator(".fm-viewer canvas[role=application]")
    if "4_1" not in lesson.url:
        assert canvas.count() == ("4_5" in lesson.url)  # the cockpit has keys of its own
        return
    canvas.scroll_into_view_if_needed()
    readout = canvas.locator("xpath=../*[contains(@class, 'fm-readout')]")
    canvas.click(position={"x": 150, "y": 120})
    settle(lesson)
    pointed = readout.inner_text()
    lesson.keyboard.press("ArrowRight")
    lesson.keyboard.press("ArrowDown")
    settle(lesson)
    column, row = (int(v) for v in pointed.split(")")[0][1:].split(","))
    assert readout.inner_text().startswith(f"({column + 1}, {row + 1})")


def test_questions_answer_at_once(lesson: Page) -> None:
    questions = lesson.locator(".fm-quiz")
    assert questions.count() >= 3
    for i in range(questions.count()):
        question = questions.nth(i)
        question.scroll_into_view_if_needed()
        if question.locator("input[type=radio]").count():
            options = question.locator("input[type=radio]")
            verdicts = set()
            for k in range(options.count()):
                options.nth(k).check()
                verdicts.add(question.locator("[aria-live]").inner_text())
            assert len(verdicts) == options.count()
        else:
            question.locator("input").fill("-999")
            lesson.keyboard.press("Enter")
            settle(lesson)
            assert question.locator("[aria-live]").inner_text()


def test_readouts_are_legible_in_light_and_dark(lesson: Page) -> None:
    for theme in ("JupyterLab Dark", "JupyterLab Light"):
        lesson.evaluate(
            "theme => window.jupyterapp.commands.execute('apputils:change-theme', {theme})", theme
        )
        lesson.wait_for_function(
            "theme => document.body.dataset.jpThemeName === theme", arg=theme, timeout=20_000
        )
        for readout in lesson.locator(".fm-readout").all():
            assert readout.evaluate(CONTRAST) >= 4.5


def test_console_stays_silent(lesson: Page) -> None:
    assert lesson.course_errors == []
