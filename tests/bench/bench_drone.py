"""
Frames per second of the simulated drone: its parts, all of them together, and as one flies it.

The first part runs in this process, in rounds that interleave: flying and drawing a frame, its
truth included; finding the well in it; both. The second is the cockpit of notebook 4.5 in a real
JupyterLab and headless Chromium, a key held down, from request to painted picture.

    python tests/bench/bench_drone.py [--frames N] [--rounds N] [--seconds S]

Exits with 1 when the bar, 10 frames per second in the browser, is missed.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

import cv2
import nbformat
import numpy as np
from nbformat.v4 import new_code_cell, new_notebook
from playwright.sync_api import sync_playwright

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "browser"))

from conftest import CHROMIUM, FLAGS, run_all, running_lab
from test_fly import COCKPIT

from course_lib.drone import Drone, RendererError
from course_lib.localize import TemplateLocator

BAR = 10.0
# Every new picture that the canvas shows is one drawImage of a bitmap not seen before.
METER = """() => {
  const draw = CanvasRenderingContext2D.prototype.drawImage;
  window.pictures = []; let last = null;
  CanvasRenderingContext2D.prototype.drawImage = function (image, ...rest) {
    if (image instanceof ImageBitmap && image !== last) {
      last = image; window.pictures.push(performance.now());
    }
    return draw.call(this, image, ...rest);
  };
}"""


def per_second(function, frames):
    start, used = time.perf_counter(), time.process_time()
    for _ in range(frames):
        function()
    wall = time.perf_counter() - start
    return frames / wall, 1000 * (time.process_time() - used) / frames


def in_process(frames, rounds):
    with Drone(seed=1, position=(-1.1, -6.0, 1.6)) as drone:
        first = drone.frame()
        x, y, w, h = cv2.boundingRect(np.array(first.truth["well"]["polygon"], np.int32))
        locator = TemplateLocator(first.image[y : y + h, x : x + w])

        def fly():
            drone.command(vx=0.2, yaw_rate=0.02)
            drone.step(0.02)
            return drone.frame()

        parts = {
            "fly and draw": fly,
            "find the well": lambda: locator.locate(first.image),
            "fly, draw, find": lambda: locator.locate(fly().image),
        }
        speeds = {name: [] for name in parts}
        for _ in range(rounds):
            for name, function in parts.items():
                speeds[name].append(per_second(function, frames))
    print(f"In one process, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f} at the end:")
    for name, values in speeds.items():
        rates, costs = zip(*values, strict=True)
        print(
            f"  {name:16s} {statistics.median(rates):6.1f} frames/s "
            f"({min(rates):.1f} to {max(rates):.1f}), "
            f"{statistics.median(costs):5.1f} ms of processor time each"
        )


def in_browser(seconds):
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        root, scratch = Path(folder) / "course", Path(folder) / "scratch"
        root.mkdir()
        notebook = new_notebook(cells=[new_code_cell(COCKPIT)])
        notebook.metadata.kernelspec = {"name": "python3", "display_name": "Python 3"}
        nbformat.write(notebook, root / "fly.ipynb")
        with running_lab(root, scratch) as lab:
            browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
            page = browser.new_page(viewport={"width": 1300, "height": 1000})
            run_all(page, lab, "fly.ipynb", seconds=150)
            page.locator(".fm-viewer canvas").click()
            page.evaluate(METER)
            page.keyboard.down("ArrowLeft")
            page.wait_for_timeout(2000)
            page.evaluate("() => { window.pictures = []; }")
            page.wait_for_timeout(1000 * seconds)
            page.keyboard.up("ArrowLeft")
            moments = page.evaluate("() => window.pictures")
            browser.close()
    gaps = np.diff(moments)
    rate = 1000 / np.mean(gaps)
    print(
        f"In the browser: {rate:.1f} frames/s over {len(moments)} pictures; between two, median "
        f"{np.median(gaps):.0f} ms, 95 % within {np.percentile(gaps, 95):.0f} ms"
    )
    return rate


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=10)
    arguments = parser.parse_args()
    try:
        in_process(arguments.frames, arguments.rounds)
    except RendererError as error:
        print(error)
        return 0
    if CHROMIUM is None:
        print("Chromium is not installed; `make system` installs it.")
        return 0
    rate = in_browser(arguments.seconds)
    print(f"Bar: {BAR:g} frames/s in the browser: {'met' if rate >= BAR else 'MISSED'}")
    return int(rate < BAR)


if __name__ == "__main__":
    sys.exit(main())
