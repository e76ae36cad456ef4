"""The cockpit in a real JupyterLab: the drone answers keys and sliders, picture by picture."""

from __future__ import annotations

import re
from typing import Any

import nbformat
import pytest
from conftest import Lab, run_all, watch_console
from nbformat.v4 import new_code_cell, new_notebook
from playwright.sync_api import Locator, Page, expect

from course_lib.drone import why_not

pytestmark = pytest.mark.skipif(bool(why_not()), reason=why_not())

COCKPIT = """
import cv2, numpy as np
from course_lib import drone, explore
pilot = drone.Drone(seed=1, position=(-1.1, -6.0, 1.6))
first = pilot.frame()
x, y, w, h = cv2.boundingRect(np.int32(first.truth["well"]["polygon"]))
explore.fly(pilot, first.image[y : y + h, x : x + w])
"""
DISTANCE = re.compile(r"([\d.]+) m from the well, ([\d.]+) m up")


@pytest.fixture(scope="module")
def cockpit(browser: Any, lab: Lab) -> Any:
    notebook = new_notebook(cells=[new_code_cell(COCKPIT)])
    notebook.metadata.kernelspec = {"name": "python3", "display_name": "Python 3"}
    nbformat.write(notebook, lab.root / "fly.ipynb")
    context = browser.new_context(viewport={"width": 1300, "height": 1000})
    page = context.new_page()
    errors = watch_console(page)
    run_all(page, lab, "fly.ipynb", seconds=150)
    expect(page.locator(".fm-viewer canvas")).to_be_visible()
    yield page
    context.close()
    assert errors == []


def readout(page: Page) -> str:
    return page.locator(".fm-readout").inner_text()


def place(page: Page) -> tuple[float, float]:
    found = DISTANCE.search(readout(page))
    assert found, readout(page)
    return float(found[1]), float(found[2])


def await_change(page: Page, what: str) -> None:
    page.wait_for_function(
        "old => document.querySelector('.fm-readout').textContent !== old", arg=what, timeout=30_000
    )


def canvas(page: Page) -> Locator:
    return page.locator(".fm-viewer canvas")


def test_keys_fly_it_while_held_and_the_well_is_outlined(cockpit: Page) -> None:
    assert canvas(cockpit).get_attribute("aria-label")
    before, _ = place(cockpit)
    canvas(cockpit).click()
    cockpit.keyboard.down("w")
    cockpit.wait_for_function(
        "() => / frames a second/.test(document.querySelector('.fm-readout').textContent)",
        timeout=60_000,
    )
    cockpit.wait_for_timeout(2500)
    flying = readout(cockpit)
    cockpit.keyboard.up("w")
    assert "forward 0.8" in flying
    assert "found," in flying
    cockpit.wait_for_function(
        "() => /Command: hover/.test(document.querySelector('.fm-readout').textContent)"
    )
    after, _ = place(cockpit)
    assert after < before - 0.1


def test_slider_sets_a_steady_velocity_and_space_stops_it(cockpit: Page) -> None:
    _, before = place(cockpit)
    cockpit.locator(".noUi-handle").nth(2).focus()
    for _ in range(4):
        cockpit.keyboard.press("ArrowRight")
    told = cockpit.locator(".fm-readout")
    expect(told).to_contain_text("up 0.4")
    cockpit.wait_for_function(
        """old => Number(document.querySelector('.fm-readout').textContent
               .match(/([0-9.]+) m up/)[1]) > old + 0.25""",
        arg=before,
        timeout=60_000,
    )
    canvas(cockpit).click()
    cockpit.keyboard.press(" ")
    expect(told).to_contain_text("Command: hover")
    # The slider follows: it is linked, not copied.
    handle = cockpit.locator(".noUi-handle").nth(2)
    assert float(handle.get_attribute("aria-valuetext")) == 0


def test_it_rests_when_nobody_commands_it(cockpit: Page) -> None:
    canvas(cockpit).click()
    cockpit.keyboard.press(" ")
    cockpit.wait_for_timeout(5000)
    rested = canvas(cockpit).evaluate("canvas => canvas.toDataURL()")
    cockpit.wait_for_timeout(1500)
    assert canvas(cockpit).evaluate("canvas => canvas.toDataURL()") == rested
    status = cockpit.evaluate(
        "() => window.jupyterapp.shell.currentWidget.context.sessionContext.session.kernel.status"
    )
    assert status == "idle"


def test_pictures_come_fast_enough_to_fly_by(cockpit: Page) -> None:
    canvas(cockpit).click()
    cockpit.keyboard.down("ArrowLeft")
    cockpit.wait_for_timeout(6000)
    found = re.search(r"(\d+) frames a second", readout(cockpit))
    cockpit.keyboard.up("ArrowLeft")
    assert found
    # Ten and more on a quiet machine (tests/bench/bench_drone.py); tests run beside others.
    assert int(found[1]) >= 2
