"""Photograph the viewers for the README: run `make site`, then this script."""

from __future__ import annotations

import io
import shutil
import sys
from pathlib import Path

from PIL import Image, ImageChops
from playwright.sync_api import sync_playwright

HERE = Path(__file__).resolve().parent
# Picture, page, which viewer of the page, how often an arrow key moves its first slider.
SHOTS = (
    ("magnifier", "4_1_fast", 0, 0),
    ("fast", "4_1_fast", 1, 10),
    ("matches", "4_4_orb_matching", 0, 0),
    ("flight", "4_5_drone", 0, 10),
)


def main(site: Path) -> None:
    """Take every picture and store it."""
    with sync_playwright() as playwright:
        flags = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=flags)
        page = browser.new_page(viewport={"width": 1200, "height": 1000})
        for name, lesson, number, steps in SHOTS:
            page.goto((site.resolve() / f"{lesson}.html").as_uri())
            viewer = page.locator(".fm-viewer").nth(number)
            viewer.scroll_into_view_if_needed()
            slider = page.locator(":has(> * .fm-viewer), :has(> .fm-viewer)").locator(
                "input[type=range]"
            )
            for _ in range(steps):
                slider.nth(number if lesson == "4_1_fast" else 0).press("ArrowRight")
            page.wait_for_timeout(600)
            shot = Image.open(io.BytesIO(viewer.screenshot())).convert("RGB")
            paper = Image.new("RGB", shot.size, shot.getpixel((shot.width - 1, 0)))
            shot = shot.crop(ImageChops.difference(shot, paper).getbbox())
            shot.save(HERE / f"{name}.png", optimize=True)
            print(f"{name}.png {shot.size}")
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("site"))
