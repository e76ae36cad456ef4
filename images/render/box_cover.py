"""Draw the box's printed cover, a board game of our own, and photograph it flat: `box.png`.

The print is drawn four times as fine as `box.png`, so that the scenes see paper, not pixels.
"""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import matplotlib as mpl
import numpy as np
import sensor
import truth
from PIL import Image, ImageDraw, ImageFont

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

SIZE = (360, 252)  # width, height of box.png
FINE = 4  # print pixels per picture pixel
W, H = SIZE[0] * FINE, SIZE[1] * FINE
EDGE = 62  # width of the ornamented border

INK, CREAM, GOLD, RED = "#14202e", "#f6e7c1", "#e2a72e", "#b8322a"
TEAL, SAND, DUSK, LEAF = "#1f6f78", "#d98e4a", "#39305c", "#5d7a37"

Point = tuple[float, float]


def font(name: str, size: int) -> ImageFont.FreeTypeFont:
    """Return a DejaVu font: they come with matplotlib, so every machine draws the same.

    Parameters
    ----------
    name : str
        Such as "Serif-Bold".
    size : int
        Pixels.

    Returns
    -------
    PIL.ImageFont.FreeTypeFont
    """
    path = Path(mpl.get_data_path()) / "fonts" / "ttf" / f"DejaVu{name}.ttf"
    return ImageFont.truetype(str(path), size, layout_engine=ImageFont.Layout.BASIC)


def shade(code: str, factor: float) -> tuple[int, int, int]:
    """Return a colour, lighter or darker.

    Parameters
    ----------
    code : str
        Such as "#f6e7c1".
    factor : float
        Above 1 is lighter.

    Returns
    -------
    tuple of 3 ints
        sRGB.
    """
    r, g, b = (min(255, int(int(code[i : i + 2], 16) * factor)) for i in (1, 3, 5))
    return r, g, b


def ring(x: float, y: float, radii: Sequence[float], count: int, turn: float = 0) -> list[Point]:
    """Return a star-shaped polygon whose points lie on the given radii in turn.

    Parameters
    ----------
    x, y : float
        Centre.
    radii : sequence of float
    count : int
        How often the radii repeat around.
    turn : float
        Radians.

    Returns
    -------
    list of (x, y)
    """
    total = count * len(radii)
    at = [(radii[i % len(radii)], turn + 2 * pi * i / total) for i in range(total)]
    return [(x + r * sin(a), y - r * cos(a)) for r, a in at]


def sky(draw: ImageDraw.ImageDraw) -> None:
    """Paint a sunburst with a ringed sun.

    Parameters
    ----------
    draw : PIL.ImageDraw.ImageDraw
    """
    x, y = W * 0.36, H * 0.60
    for i in range(36):
        a, b = 2 * pi * i / 36, 2 * pi * (i + 1) / 36
        colour = shade(SAND if i % 2 else GOLD, 0.98 if i % 4 < 2 else 1.12)
        far = [(x + 2000 * cos(t), y + 2000 * sin(t)) for t in (a, b)]
        draw.polygon([(x, y), *far], fill=colour)
    for radius, colour in ((178, RED), (160, CREAM), (146, GOLD), (112, CREAM), (98, RED)):
        draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=colour)
    draw.polygon(ring(x, y, (92, 40), 14), fill=CREAM)


def facets(
    draw: ImageDraw.ImageDraw,
    rng: np.random.Generator,
    skyline: Sequence[Point],
    foot: float,
    colours: Sequence[str],
    step: float,
) -> None:
    """Fill the ground below a skyline with triangles of uneven brightness.

    Parameters
    ----------
    draw : PIL.ImageDraw.ImageDraw
    rng : numpy.random.Generator
    skyline : sequence of (x, y)
        From left to right.
    foot : float
        Lower edge.
    colours : sequence of str
        From the top down.
    step : float
        Typical side of a triangle.
    """
    line = np.array(skyline)
    grid = [
        (x + rng.uniform(-0.4, 0.4) * step, y + rng.uniform(-0.4, 0.4) * step)
        for y in np.arange(line[:, 1].min(), foot + step, step)
        for x in np.arange(0, W + step, step)
    ]
    subdivision = cv2.Subdiv2D((-200, -200, W + 400, H + 400))
    inside = [p for p in grid if p[1] > np.interp(p[0], line[:, 0], line[:, 1]) + step * 0.35]
    for x, y in [*skyline, *inside]:
        subdivision.insert((float(x), float(y)))
    for triangle in subdivision.getTriangleList().reshape(-1, 3, 2):
        x, y = triangle.mean(axis=0)
        top = np.interp(x, line[:, 0], line[:, 1])
        if y < top - 1 or (np.abs(triangle - (W / 2, H / 2)) > (W, H)).any():
            continue
        # Snow on the peaks, darker towards the valley, lit from the left.
        depth = (y - line[:, 1].min()) / (foot - line[:, 1].min())
        colour = colours[
            int(np.clip(depth * len(colours) + rng.normal(0, 0.25), 0, len(colours) - 1))
        ]
        draw.polygon([tuple(p) for p in triangle], fill=shade(colour, rng.uniform(0.72, 1.22)))


def town(draw: ImageDraw.ImageDraw, rng: np.random.Generator, foot: float) -> None:
    """Build crooked houses with roofs, doors and windows.

    Parameters
    ----------
    draw : PIL.ImageDraw.ImageDraw
    rng : numpy.random.Generator
    foot : float
        Where the houses stand.
    """
    x = EDGE + 8.0
    while x < W * 0.70:
        width, height = rng.uniform(74, 122), rng.uniform(92, 215)
        wall = [CREAM, TEAL, RED, SAND, "#8fb0a9"][rng.integers(5)]
        roof = [INK, RED, DUSK, LEAF][rng.integers(4)]
        top = foot - height
        draw.rectangle((x, top, x + width, foot), fill=wall, outline=INK, width=5)
        peak = (x + width * rng.uniform(0.2, 0.8), top - rng.uniform(34, 96))
        draw.polygon([(x - 9, top), peak, (x + width + 9, top)], fill=roof, outline=INK, width=5)
        pane = rng.choice([17, 21, 26])
        for row in np.arange(top + 14, foot - 48, pane + 17):
            for left in np.arange(x + 13, x + width - pane - 6, pane + 14):
                glass = GOLD if rng.random() < 0.6 else INK
                draw.rectangle(
                    (left, row, left + pane, row + pane), fill=glass, outline=INK, width=4
                )
        door = x + rng.uniform(10, width - 36)
        draw.rectangle((door, foot - 42, door + 26, foot), fill=INK)
        x += width + rng.uniform(-4, 14)


def drone(draw: ImageDraw.ImageDraw, x: float, y: float) -> None:
    """Draw the hero: a drone whose eye looks for corners.

    Parameters
    ----------
    draw : PIL.ImageDraw.ImageDraw
    x, y : float
        Centre.
    """
    beam = [(x - 20, y + 60), (x - 190, y + 390), (x + 130, y + 390), (x + 40, y + 60)]
    draw.polygon(beam, fill="#f7d98a")
    for side in (-1, 1):
        for reach, lift in ((205, -64), (150, 26)):
            ex, ey = x + side * reach, y + lift
            draw.line((x, y, ex, ey), fill=INK, width=20)
            draw.line((ex, ey, ex, ey - 38), fill=INK, width=13)
            blade = (ex - 88, ey - 56, ex + 88, ey - 34)
            draw.ellipse(blade, fill=CREAM, outline=INK, width=6)
            draw.ellipse((ex - 14, ey - 60, ex + 14, ey - 30), fill=RED, outline=INK, width=5)
    draw.rounded_rectangle((x - 98, y - 62, x + 98, y + 62), 34, fill=TEAL, outline=INK, width=10)
    for i in range(6):
        draw.rectangle((x - 78 + 28 * i, y - 50, x - 64 + 28 * i, y - 34), fill=GOLD)
    for r, colour in ((48, INK), (39, CREAM), (27, RED), (14, INK)):
        draw.ellipse((x - r, y + 8 - r, x + r, y + 8 + r), fill=colour)
    draw.ellipse((x - 4, y - 12, x + 10, y + 2), fill=CREAM)


def lettering(
    draw: ImageDraw.ImageDraw, at: Point, text: str, size: int, *, name: str, fill: str, stroke: int
) -> None:
    """Write with an outline and a shadow, centred.

    Parameters
    ----------
    draw : PIL.ImageDraw.ImageDraw
    at : tuple of float
        Middle of the line.
    text : str
    size : int
        Pixels.
    name : str
        Of the DejaVu font.
    fill : str
    stroke : int
        Width of the outline, pixels.
    """
    face = font(name, size)
    x, y = at
    lower = (x + size / 14, y + size / 14)
    draw.text(lower, text, font=face, anchor="mm", fill=RED, stroke_width=stroke, stroke_fill=RED)
    draw.text(at, text, font=face, anchor="mm", fill=fill, stroke_width=stroke, stroke_fill=INK)


def border(draw: ImageDraw.ImageDraw) -> None:
    """Frame the cover with diamonds and corner stars.

    Parameters
    ----------
    draw : PIL.ImageDraw.ImageDraw
    """
    for box in ((0, 0, W, EDGE), (0, H - EDGE, W, H), (0, 0, EDGE, H), (W - EDGE, 0, W, H)):
        draw.rectangle(box, fill=DUSK)
    half = EDGE / 2
    for along, across, flip in ((W, H, False), (H, W, True)):
        count = round((along - 2 * EDGE) / EDGE)
        for i in range(count):
            t = EDGE + (i + 0.5) * (along - 2 * EDGE) / count
            for s in (half, across - half):
                x, y = (s, t) if flip else (t, s)
                draw.polygon(ring(x, y, (half - 7,), 4), fill=GOLD if i % 2 else CREAM)
                draw.polygon(ring(x, y, (half - 19,), 4), fill=RED if i % 3 else TEAL)
    for x in (half, W - half):
        for y in (half, H - half):
            draw.rectangle((x - half, y - half, x + half, y + half), fill=RED)
            draw.polygon(ring(x, y, (half - 3, 11), 8), fill=CREAM)
    draw.rectangle((EDGE, EDGE, W - EDGE, H - EDGE), outline=INK, width=9)
    draw.rectangle((3, 3, W - 4, H - 4), outline=INK, width=8)


def footer(draw: ImageDraw.ImageDraw) -> None:
    """Write what a box says below: players, minutes, age; and the badge.

    Parameters
    ----------
    draw : PIL.ImageDraw.ImageDraw
    """
    top, bottom = H - EDGE - 92, H - EDGE - 8
    draw.rectangle((EDGE + 8, top, W - EDGE - 8, bottom), fill=INK)
    draw.line((EDGE + 8, top, W - EDGE - 8, top), fill=GOLD, width=8)
    middle = (top + bottom) / 2
    for i, colour in enumerate((RED, GOLD, TEAL, CREAM)):
        x = EDGE + 52 + 50 * i
        draw.ellipse((x - 12, middle - 34, x + 12, middle - 10), fill=colour)
        draw.polygon([(x, middle - 22), (x + 20, middle + 32), (x - 20, middle + 32)], fill=colour)
    face = font("Sans-Bold", 46)
    draw.text((EDGE + 262, middle), "2–4 PLAYERS", font=face, anchor="lm", fill=CREAM)
    draw.text((EDGE + 640, middle), "45 MIN", font=face, anchor="lm", fill=GOLD)
    draw.text((EDGE + 860, middle), "AGE 9+", font=face, anchor="lm", fill=CREAM)
    for i in range(10):
        for j in range(3):
            if (i * 3 + j * 5 + i * j) % 4 < 2:
                x, y = W - EDGE - 222 + 20 * i, middle - 30 + 20 * j
                draw.rectangle((x, y, x + 19, y + 19), fill=CREAM)
    x, y = W - EDGE - 168, H - EDGE - 236
    draw.polygon(ring(x, y, (122, 100), 18), fill=CREAM, outline=INK, width=7)
    draw.ellipse((x - 90, y - 90, x + 90, y + 90), fill=RED, outline=INK, width=6)
    draw.text((x, y - 20), "100", font=font("Sans-Bold", 72), anchor="mm", fill=CREAM)
    draw.text((x, y + 40), "PAIRS", font=font("Sans-Bold", 38), anchor="mm", fill=GOLD)


def cover() -> NDArray[np.uint8]:
    """Draw the print.

    Returns
    -------
    ndarray, shape (1008, 1440, 3), uint8
        BGR.
    """
    rng = np.random.default_rng(4)
    picture = Image.new("RGB", (W, H), SAND)
    draw = ImageDraw.Draw(picture)
    sky(draw)
    far = [(x, H * 0.52 + rng.uniform(-95, 75)) for x in np.linspace(-60, W + 60, 15)]
    facets(draw, rng, far, H * 0.86, [CREAM, "#a9a3c0", DUSK, DUSK], 62)
    near = [(x, H * 0.68 + rng.uniform(-45, 45)) for x in np.linspace(-60, W + 60, 12)]
    facets(draw, rng, near, H, [LEAF, TEAL, "#234b3c"], 56)
    drone(draw, W * 0.72, H * 0.45)
    town(draw, rng, H - EDGE - 90)
    footer(draw)
    border(draw)
    lettering(draw, (W / 2, 148), "CORNER QUEST", 142, name="Serif-Bold", fill=CREAM, stroke=11)
    lettering(
        draw,
        (W * 0.36, 262),
        "a game of keen eyes",
        58,
        name="Serif-BoldItalic",
        fill=GOLD,
        stroke=7,
    )
    return cv2.cvtColor(np.asarray(picture), cv2.COLOR_RGB2BGR)


def main(out: Path, *, preview: bool = False) -> None:  # noqa: ARG001 - the same picture either way
    """Draw the cover and write box.png with its record.

    Parameters
    ----------
    out : Path
        images/.
    preview : bool
        Makes no difference: drawing takes a second.
    """
    flat = cv2.resize(cover(), SIZE, interpolation=cv2.INTER_AREA)
    sensor.save(out / "box.png", sensor.expose(flat, seed=1, vignetting=0.04, blur=0.4))
    truth.write(out / "truth" / "box.json", {"image": "box.png", "size": SIZE, "objects": {}})


if __name__ == "__main__":
    main(Path(__file__).resolve().parent.parent)
