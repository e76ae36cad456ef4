"""The pages in a real browser: sorting, filtering, and nothing of a submission that runs."""

from __future__ import annotations

import sys
from pathlib import Path
from urllib.parse import quote

import pytest

sys.path.append(str(Path(__file__).resolve().parents[1] / "grading"))

from demo_class import ATTACK, demo_class, hostile

from course_lib.grading import report


def put(out, made):
    for one in made:
        report.write_student(one, report.student_folder(out, one.student))
    report.write_class(out)
    return out


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    return put(tmp_path_factory.mktemp("demo"), demo_class())


def column(page, table, index):
    return page.locator(f"{table} tbody tr:visible > :nth-child({index})").all_inner_texts()


def test_students_are_sorted_by_any_column(page, demo):
    page.goto((demo / "index.html").as_uri())
    total = page.locator("#class thead button", has_text="Total")
    total.click()
    up = [float(text) for text in column(page, "#class", 4)]
    assert up == sorted(up)
    assert len(up) == len(demo_class())
    assert page.locator("#class th[aria-sort=ascending]").inner_text() == "Total"
    total.focus()
    page.keyboard.press("Enter")
    down = [float(text) for text in column(page, "#class", 4)]
    assert down == sorted(up, reverse=True)
    page.locator("#class thead button", has_text="Student").click()
    names = column(page, "#class", 1)
    assert names[0] == "Amara Okafor"
    assert names[-1] == "Zoë de Vries"
    page.locator("main > section table.sortable thead button", has_text="Mean").click()
    shares = [
        int(text.split()[0]) for text in column(page, "section[aria-labelledby=tests] table", 4)
    ]
    assert shares == sorted(shares)


def test_students_are_filtered(page, demo):
    page.goto((demo / "index.html").as_uri())
    assert page.locator("#count").inner_text() == "25 of 25"
    page.get_by_label("Find").fill("ra")
    shown = column(page, "#class", 1)
    assert shown
    assert all("ra" in name.lower() for name in shown)
    assert page.locator("#count").inner_text() == f"{len(shown)} of 25"
    page.get_by_label("Find").fill("")
    page.get_by_label("Show").select_option("alike")
    assert column(page, "#class", 1) == ["Elif Şahin", "Kavya Rao", "Pedro Alves"]
    page.get_by_label("Show").select_option("incomplete")
    assert column(page, "#class", 1) == ["Carla Jiménez", "Jonas Weber", "Xaver Huber"]


def test_the_class_page_is_complete_without_script(browser, demo):
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto((demo / "index.html").as_uri())
    assert len(column(page, "#class", 1)) == 25
    assert not page.get_by_label("Find").is_visible()
    page.get_by_role("link", name="Carla Jiménez").first.click()
    assert page.locator("h1").inner_text() == "Carla Jiménez"
    context.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_pages_fit_narrow_windows_and_can_be_read(browser, demo, scheme):
    context = browser.new_context(color_scheme=scheme, viewport={"width": 400, "height": 800})
    page = context.new_page()
    for name in (
        "Carla Jiménez/report.html",
        "_instructor/Carla Jiménez/report.html",
        "index.html",
    ):
        page.goto((demo / name).as_uri())
        assert page.evaluate("document.documentElement.scrollWidth") <= 400
        # What is read stands out from what it stands on: WCAG's contrast of 4.5.
        faint = page.evaluate(
            """() => {
              const light = (rgb) => {
                const [r, g, b] = rgb.map((v) => (v / 255 <= 0.03928 ? v / 255 / 12.92
                  : ((v / 255 + 0.055) / 1.055) ** 2.4));
                return 0.2126 * r + 0.7152 * g + 0.0722 * b;
              };
              const numbers = (text) => text.match(/[\\d.]+/g).map(Number);
              const behind = (node) => {
                for (let at = node; at; at = at.parentElement) {
                  const colour = numbers(getComputedStyle(at).backgroundColor);
                  if (colour.length === 3) return colour;
                }
              };
              return [...document.querySelectorAll("main *:not(svg *)")]
                .filter((n) => [...n.childNodes].some((c) => c.nodeType === 3 && c.data.trim()))
                .filter((n) => {
                  const colour = numbers(getComputedStyle(n).color).slice(0, 3);
                  const [a, b] = [colour, behind(n)].map(light);
                  return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) < 4.5;
                }).map((n) => n.outerHTML.slice(0, 100));
            }"""
        )
        assert faint == []
    context.close()


def test_a_hostile_result_runs_nothing(page, tmp_path):
    names = [
        "<img src=x onerror=document.title='owned'>",
        "javascript:document.title='owned'",
        "a#b?c%2F",
    ]
    made = [hostile(), *(hostile(name) for name in names)]
    put(tmp_path, made)
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("dialog", lambda dialog: pytest.fail(dialog.message))
    for one in made:
        folder = report.student_folder(tmp_path, one.student)
        for path in (folder, tmp_path / "_instructor" / folder.name):
            page.goto((path / "report.html").as_uri())
            assert "owned" not in page.title().replace("document.title='owned'", "")
            assert page.locator("script").count() == 0
            text = page.locator("main").inner_text()
            assert "<script>document.title='owned'</script>" in text
            assert "\x1b" not in text
            assert "\u202e" not in text
            assert (
                page.evaluate("document.querySelectorAll('main [onerror], main [onload]').length")
                == 0
            )
    page.goto((tmp_path / "index.html").as_uri())
    assert page.locator("script").count() == 1
    for one in made:
        folder = report.student_folder(tmp_path, one.student)
        link = page.locator(f'#class a[href="{quote(folder.name, safe="")}/report.html"]')
        link.click()
        assert page.locator("h1").inner_text().split() == one.student.split()
        page.go_back()
    assert page.title() == f"The class: {len(made)} graded"
    assert ATTACK[:40] in page.locator("main").inner_text()
    assert {url.split(":")[0] for url in asked} <= {"file", "data"}


def test_no_other_script_runs_on_the_class_page(browser, demo, tmp_path):
    # If escaping ever failed, the policy would still hold.
    raw = (demo / "index.html").read_text("utf-8")
    broken = raw.replace(
        "</main>",
        "<script>document.title = 'owned'</script><img src=x onerror=\"document.title='owned'\">"
        "<a id=evil href=\"javascript:document.title='owned'\">x</a></main>",
    )
    (tmp_path / "index.html").write_text(broken, "utf-8")
    context = browser.new_context()
    page = context.new_page()
    refused: list[str] = []
    page.on("console", lambda message: refused.append(message.text))
    page.goto((tmp_path / "index.html").as_uri())
    page.locator("#evil").click()
    page.wait_for_function("document.querySelector('#count').value === '25 of 25'")
    assert page.title() == "The class: 25 graded"
    assert sum("Content Security Policy" in text for text in refused) >= 3
    context.close()


def test_on_paper_it_is_light_and_without_controls(browser, demo):
    context = browser.new_context(color_scheme="dark")
    page = context.new_page()
    page.goto((demo / "index.html").as_uri())
    page.emulate_media(media="print", color_scheme="dark")
    assert not page.get_by_label("Find").is_visible()
    body = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert body == "rgb(255, 255, 255)"
    context.close()
