"""The exported course: opened from the disk, with no kernel and no network."""

from __future__ import annotations

import functools
import http.server
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from conftest import watch_console
from playwright.sync_api import Browser, Locator, Page, expect
from sample_course import write_sample_course

from course_lib.publish.widgets import CONTROLS

ROOT = Path(__file__).resolve().parents[2]
LESSONS = sorted(path.stem for path in (ROOT / "notebooks").glob("*.ipynb"))
PICTURE = "canvas => canvas.toDataURL()"
# The first test waits until every notebook has been executed.
pytestmark = pytest.mark.timeout(900)


def export(notebooks: Path, out: Path) -> Path:
    command = [sys.executable, "-m", "course_lib.publish.site", str(notebooks), "--out", str(out)]
    done = subprocess.run(command, cwd=ROOT, check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return out


@pytest.fixture(scope="module")
def sample(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sample")
    write_sample_course(folder / "notebooks")
    return export(folder / "notebooks", folder / "site")


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(ROOT / "notebooks", tmp_path_factory.mktemp("course") / "site")


@pytest.fixture
def reader(browser: Browser) -> Iterator[Page]:
    """A browser without network; the test fails when a page asked for it or logged an error."""
    context = browser.new_context(viewport={"width": 1300, "height": 1000}, color_scheme="light")
    page = context.new_page()
    errors, asked = watch_console(page), []

    def refuse(route: Any) -> None:
        asked.append(route.request.url)
        route.abort()

    page.route(lambda url: not url.startswith(("file:", "data:", "blob:")), refuse)
    yield page
    context.close()
    assert (errors, asked) == ([], [])


def read(page: Page, address: Path | str) -> None:
    page.goto(address.as_uri() if isinstance(address, Path) else address)
    page.wait_for_selector("html[data-widgets=ready]")


def expect_new_picture(canvas: Locator, old: str) -> None:
    canvas.page.wait_for_function(
        "([canvas, old]) => canvas.toDataURL() !== old", arg=[canvas.element_handle(), old]
    )


def widget(page: Page, label: str) -> Locator:
    return page.locator(".widget", has=page.get_by_label(label, exact=True))


def radius(page: Page, label: str) -> Any:
    return expect(widget(page, label).locator("[data-radius]"))


def test_page_shows_its_widgets_in_place_of_the_stills(sample: Path, reader: Page) -> None:
    read(reader, sample / "lesson.html")
    count = reader.locator(".widget").count()
    assert count == reader.locator(".widget[data-live] canvas").count() == 7
    assert reader.locator(".widget img").count() == 0


def test_slider_answers_the_keyboard(sample: Path, reader: Page) -> None:
    read(reader, sample / "lesson.html")
    canvas = widget(reader, "Radius").locator("canvas")
    old = canvas.evaluate(PICTURE)
    reader.get_by_label("Radius").press("ArrowRight")
    radius(reader, "Radius").to_have_attribute("data-radius", "11")
    expect(widget(reader, "Radius").locator("output")).to_have_text("11")
    assert canvas.evaluate(PICTURE) != old


def test_slider_answers_the_mouse(sample: Path, reader: Page) -> None:
    read(reader, sample / "lesson.html")
    reader.get_by_label("Radius").scroll_into_view_if_needed()
    box = reader.get_by_label("Radius").bounding_box()
    assert box
    reader.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    reader.mouse.down()
    reader.mouse.move(box["x"] + box["width"] - 1, box["y"] + box["height"] / 2)
    reader.mouse.up()
    radius(reader, "Radius").to_have_attribute("data-radius", "50")


def test_every_control_moves_its_canvas(sample: Path, reader: Page) -> None:
    read(reader, sample / "lesson.html")
    reader.get_by_label("Size").select_option("b")
    radius(reader, "Size").to_have_attribute("data-radius", "1")
    reader.get_by_label("large").check()
    radius(reader, "large").to_have_attribute("data-radius", "1")
    reader.get_by_label("Log").press("End")
    radius(reader, "Log").to_have_attribute("data-radius", "39.810717055349734")
    reader.get_by_label("Typed").fill("70")
    reader.get_by_label("Typed").press("Enter")
    radius(reader, "Typed").to_have_attribute("data-radius", "50")  # its upper limit
    reader.get_by_label("Shown").uncheck()
    radius(reader, "Shown").to_have_attribute("data-radius", "false")


def test_play_runs_to_its_end_and_stops(sample: Path, reader: Page) -> None:
    read(reader, sample / "lesson.html")
    button = reader.get_by_label("play")
    canvas = reader.locator(".widget", has=button).locator("[data-radius]").element_handle()
    button.click()
    reader.wait_for_function("element => element.dataset.radius === '6'", arg=canvas)
    expect(reader.get_by_label("play")).to_be_visible()


def test_formulas_are_set_without_scripts(sample: Path, reader: Page) -> None:
    read(reader, sample / "lesson.html")
    assert reader.locator("math").count() == 3
    big = reader.locator(".formula math").last.bounding_box()
    assert big
    assert big["height"] > 40  # two lines of a case distinction, not one line of source
    assert "atan2" in reader.locator("math mtext").all_text_contents()


def test_links_lead_from_page_to_page(sample: Path, reader: Page) -> None:
    read(reader, sample / "lesson.html")
    reader.get_by_role("main").get_by_role("link", name="link", exact=True).click()
    assert reader.url.endswith("/index.html#Second-part")
    expect(reader.locator("#Second-part")).to_be_in_viewport()


def test_theme_is_chosen_and_kept(sample: Path, reader: Page) -> None:
    read(reader, sample / "lesson.html")
    paper = "() => getComputedStyle(document.body).backgroundColor"
    light = reader.evaluate(paper)
    reader.get_by_role("button", name="Dark").click()
    dark = reader.evaluate(paper)
    assert (light, dark) == ("rgb(255, 255, 255)", "rgb(20, 24, 29)")
    assert reader.locator("body").get_attribute("data-jp-theme-name") == "dark"
    read(reader, sample / "index.html")
    assert reader.evaluate(paper) == dark


def test_narrow_page_needs_no_sideways_scrolling(sample: Path, reader: Page) -> None:
    reader.set_viewport_size({"width": 360, "height": 800})
    read(reader, sample / "lesson.html")
    assert reader.evaluate("document.documentElement.scrollWidth") <= 360


def test_paper_has_no_navigation(sample: Path, reader: Page) -> None:
    read(reader, sample / "lesson.html")
    reader.emulate_media(media="print")
    expect(reader.locator("nav.course")).to_be_hidden()
    expect(reader.locator(".widget canvas").first).to_be_visible()


def test_still_picture_stays_without_scripts(sample: Path, browser: Browser) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto((sample / "lesson.html").as_uri())
    expect(page.locator(".widget img").first).to_be_visible()
    context.close()


def test_python_knows_the_controls_that_the_page_has(sample: Path, reader: Page) -> None:
    read(reader, sample / "lesson.html")
    assert set(reader.evaluate("Object.keys(CONTROLS)")) == CONTROLS


def test_pages_work_behind_a_server_too(sample: Path, browser: Browser) -> None:
    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None: ...

    handler = functools.partial(Quiet, directory=str(sample))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        page = browser.new_page()
        errors = watch_console(page)
        read(page, f"http://127.0.0.1:{server.server_port}/lesson.html")
        assert page.locator(".widget[data-live]").count() == 7
        page.close()
        server.shutdown()
    assert errors == []


@pytest.mark.parametrize("name", LESSONS)
def test_course_page_is_complete(course: Path, reader: Page, name: str) -> None:
    read(reader, course / f"{name}.html")
    assert reader.locator(".widget").count() == reader.locator(".widget[data-live]").count()
    pictures = reader.locator("img")
    for i in range(pictures.count()):
        assert (pictures.nth(i).get_attribute("alt") or "").strip()
    loaded = "images => images.every((image) => image.complete && image.naturalWidth > 0)"
    assert pictures.evaluate_all(loaded)
    dead = """links => links.map((a) => a.getAttribute("href")).filter(
      (href) => href.startsWith("#") && !document.getElementById(href.slice(1)))"""
    assert reader.locator("a[href]").evaluate_all(dead) == []


@pytest.mark.parametrize("name", [name for name in LESSONS if name != "index"])
def test_course_sliders_answer_without_a_kernel(course: Path, reader: Page, name: str) -> None:
    read(reader, course / f"{name}.html")
    viewers = reader.locator(".widget", has=reader.locator("canvas"))
    assert viewers.count() > 0
    for i in range(viewers.count()):
        canvas = viewers.nth(i).locator("canvas").first
        sliders = viewers.nth(i).locator("input[type=range]")
        assert sliders.count() > 0
        for j in range(sliders.count()):
            old = canvas.evaluate(PICTURE)
            # Far enough to matter, whichever end the slider stands at.
            at_end = sliders.nth(j).evaluate("s => Number(s.value) * 2 > Number(s.max)")
            sliders.nth(j).press("Home" if at_end else "End")
            expect_new_picture(canvas, old)


@pytest.mark.parametrize("name", [name for name in LESSONS if name != "index"])
def test_course_questions_answer_without_a_kernel(course: Path, reader: Page, name: str) -> None:
    read(reader, course / f"{name}.html")
    questions = reader.locator(".fm-quiz")
    assert questions.count() >= 3
    for i in range(questions.count()):
        question = questions.nth(i)
        if question.locator("input[type=radio]").count():
            question.locator("input[type=radio]").first.check()
        else:
            question.locator("input[type=text]").fill("-12345")
            question.get_by_role("button", name="Check").click()
        expect(question.locator(".fm-verdict")).to_contain_text(".")
