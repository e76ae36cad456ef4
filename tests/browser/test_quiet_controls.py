"""A drag is painted in the browser; the kernel hears of it once, when the slider rests."""

from __future__ import annotations

from typing import Any

import nbformat
from conftest import Lab, run_all
from nbformat.v4 import new_code_cell, new_notebook
from playwright.sync_api import Page, WebSocket, expect

VIEWER = """
import numpy as np
from course_lib import explore
rng = np.random.default_rng(1)
viewer = explore.fast(rng.integers(0, 256, (120, 160), dtype=np.uint8), threshold=30)
viewer
"""
STEPS = 20


def test_a_drag_is_one_message_to_the_kernel(page: Page, lab: Lab) -> None:
    cells = [VIEWER.strip(), "print('it is at', viewer.children[0].value)"]
    notebook = new_notebook(cells=[new_code_cell(cell) for cell in cells])
    notebook.metadata.kernelspec = {"name": "python3", "display_name": "Python 3"}
    nbformat.write(notebook, lab.root / "quiet.ipynb")
    sent: list[Any] = []

    def note(message: str | bytes) -> None:
        sent.append(message)

    def listen(socket: WebSocket) -> None:
        if "/channels" in socket.url:
            socket.on("framesent", note)

    page.on("websocket", listen)
    run_all(page, lab, "quiet.ipynb")
    viewer = page.locator(".fm-box")
    expect(viewer.locator(".fm-readout")).to_contain_text("at threshold 30")
    page.wait_for_timeout(1000)
    sent.clear()

    viewer.locator(".noUi-handle").focus()
    for _ in range(STEPS):
        page.keyboard.down("ArrowRight")
    page.keyboard.up("ArrowRight")
    expect(viewer.locator(".fm-readout")).to_contain_text(f"at threshold {30 + STEPS}")
    page.wait_for_timeout(1500)
    assert 1 <= len(sent) <= 4  # slider and canvas; twice, should the machine have paused

    page.evaluate(
        """() => {
          window.jupyterapp.shell.currentWidget.content.activeCellIndex = 1;
          return window.jupyterapp.commands.execute("notebook:run-cell");
        }"""
    )
    expect(page.locator(".jp-CodeCell").nth(1)).to_contain_text(f"it is at {30 + STEPS}")
