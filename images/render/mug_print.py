"""The drawing on the mug: "I'm a ROS developer", a robot, gears and a graph of nodes.

The print is drawn flat, as the transfer that a potter would lay around the cylinder, in units of
its own width, so that the resolution is a parameter and nothing else.
"""

import math
from functools import cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
from PIL import Image, ImageDraw, ImageFont

# Width over height of the transfer; mug.py cuts the printed rectangle to the same ratio.
ASPECT = 1.44
INK = (24, 32, 56)
TEAL = (0, 128, 140)
ORANGE = (226, 106, 30)
RED = (196, 44, 52)
YELLOW = (244, 190, 52)
GREY = (120, 130, 144)
PAPER = (255, 255, 255)


@cache
def font(size: int, face: str = "DejaVuSans-Bold") -> ImageFont.FreeTypeFont:
    """Return a font that matplotlib ships, `size` pixels high."""
    folder = Path(mpl.get_data_path()) / "fonts" / "ttf"
    return ImageFont.truetype(str(folder / f"{face}.ttf"), size)


class Transfer:
    """A canvas whose coordinates are fractions of its width, with y down.

    Parameters
    ----------
    width : int
        Width of the finished transfer in pixels; it is drawn at twice that and reduced.
    """

    def __init__(self, width: int) -> None:
        self.size = (width, round(width / ASPECT))
        self._scale = 2 * width
        canvas = (self._scale, 2 * self.size[1])
        self._image = Image.new("RGB", canvas, PAPER)
        self._draw = ImageDraw.Draw(self._image)

    def _pixels(self, *values: float) -> list[float]:
        return [value * self._scale for value in values]

    def _stroke(self, width: float) -> int:
        return max(1, round(width * self._scale))

    def text(
        self,
        xy: tuple[float, float],
        words: str,
        size: float,
        ink: tuple[int, int, int],
        face: str = "DejaVuSans-Bold",
    ) -> None:
        """Write words with their left end and their baseline at `xy`."""
        face_font = font(round(size * self._scale), face)
        self._draw.text(self._pixels(*xy), words, fill=ink, font=face_font, anchor="ls")

    def line(self, points: list[tuple[float, float]], width: float, ink=INK) -> None:
        """Draw a polyline with rounded joints and ends."""
        flat = [tuple(self._pixels(*point)) for point in points]
        self._draw.line(flat, fill=ink, width=self._stroke(width), joint="curve")
        for x, y in points:
            self.disc((x, y), width / 2, ink)

    def disc(self, centre, radius: float, fill, outline=None, width: float = 0.0) -> None:
        """Draw a filled circle."""
        x, y = centre
        box = self._pixels(x - radius, y - radius, x + radius, y + radius)
        self._draw.ellipse(box, fill=fill, outline=outline, width=self._stroke(width))

    def box(self, corners, fill, outline=INK, width: float = 0.007, radius: float = 0.012) -> None:
        """Draw a rectangle (x0, y0, x1, y1) with rounded corners."""
        self._draw.rounded_rectangle(
            self._pixels(*corners),
            radius=radius * self._scale,
            fill=fill,
            outline=outline,
            width=self._stroke(width),
        )

    def polygon(self, points, fill, outline=None, width: float = 0.005) -> None:
        """Draw a filled polygon."""
        flat = [tuple(self._pixels(*point)) for point in points]
        self._draw.polygon(flat, fill=fill, outline=outline, width=self._stroke(width))

    def gear(self, centre, radius: float, teeth: int, fill, phase: float = 0.0) -> None:
        """Draw a toothed wheel with spokes."""
        x, y = centre
        rim = []
        for tooth in range(teeth):
            for offset, reach in ((-0.30, 0.80), (-0.19, 1.0), (0.19, 1.0), (0.30, 0.80)):
                angle = 2 * math.pi * (tooth + offset + phase) / teeth
                rim.append(
                    (x + reach * radius * math.cos(angle), y + reach * radius * math.sin(angle))
                )
        self.polygon(rim, fill, INK)
        self.disc(centre, 0.58 * radius, PAPER, INK, 0.004)
        for spoke in range(4):
            angle = math.pi * (spoke / 2 + phase)
            tip = (x + 0.56 * radius * math.cos(angle), y + 0.56 * radius * math.sin(angle))
            self.line([centre, tip], 0.12 * radius)
        self.disc(centre, 0.22 * radius, fill, INK, 0.004)

    def arrow(self, start, end, ink=INK, width: float = 0.006) -> None:
        """Draw an arrow from `start` to `end`."""
        angle = math.atan2(end[1] - start[1], end[0] - start[0])
        head = 0.024
        neck = (end[0] - head * math.cos(angle), end[1] - head * math.sin(angle))
        self.line([start, neck], width, ink)
        side = (0.5 * head * -math.sin(angle), 0.5 * head * math.cos(angle))
        barbs = [(neck[0] + s * side[0], neck[1] + s * side[1]) for s in (1, -1)]
        self.polygon([end, *barbs], ink)

    def finish(self) -> np.ndarray:
        """Return the transfer as RGB uint8 (height, width, 3)."""
        return np.asarray(self._image.resize(self.size, Image.Resampling.LANCZOS))


def _words(art: Transfer) -> None:
    art.text((0.13, 0.125), "I'm a", 0.098, INK, "DejaVuSerif-BoldItalic")
    art.text((0.125, 0.315), "ROS", 0.205, RED)
    art.text((0.13, 0.425), "developer", 0.084, INK)
    art.line([(0.13, 0.455), (0.84, 0.455)], 0.006, TEAL)
    art.text((0.43, 0.119), "{ code; }", 0.034, TEAL, "DejaVuSansMono-Bold")
    art.text(
        (0.13, 0.482), "sense > think > act > debug > coffee", 0.025, GREY, "DejaVuSansMono-Bold"
    )


def _robot(art: Transfer) -> None:
    art.line([(0.735, 0.045), (0.735, 0.09)], 0.008)
    art.disc((0.735, 0.04), 0.016, ORANGE, INK, 0.005)
    art.box((0.65, 0.085, 0.82, 0.2), TEAL, radius=0.03)
    for x in (0.695, 0.775):
        art.disc((x, 0.135), 0.026, PAPER, INK, 0.006)
        art.disc((x + 0.006, 0.14), 0.012, INK)
        art.disc((x + 0.01, 0.136), 0.004, PAPER)
    art.box((0.69, 0.172, 0.78, 0.19), YELLOW, width=0.004, radius=0.006)
    for x in (0.7125, 0.735, 0.7575):
        art.line([(x, 0.174), (x, 0.188)], 0.003)
    art.box((0.635, 0.115, 0.652, 0.165), ORANGE, width=0.005, radius=0.005)
    art.box((0.818, 0.115, 0.835, 0.165), ORANGE, width=0.005, radius=0.005)
    art.box((0.715, 0.2, 0.755, 0.218), GREY, width=0.005, radius=0.002)
    art.box((0.655, 0.215, 0.815, 0.345), PAPER, radius=0.018)
    art.gear((0.715, 0.275), 0.045, 9, YELLOW, 0.1)
    art.gear((0.78, 0.312), 0.026, 7, ORANGE, 0.35)
    for index, ink in enumerate((RED, YELLOW, TEAL)):
        art.disc((0.773 + 0.015 * index, 0.237), 0.006, ink, INK, 0.002)
    art.line([(0.655, 0.24), (0.617, 0.27), (0.63, 0.315)], 0.014, GREY)
    art.line([(0.815, 0.24), (0.86, 0.225), (0.875, 0.17)], 0.014, GREY)
    art.line([(0.862, 0.145), (0.875, 0.17), (0.897, 0.152)], 0.011)
    art.line([(0.618, 0.335), (0.63, 0.315), (0.646, 0.332)], 0.011)
    for x in (0.685, 0.735, 0.785):
        art.disc((x, 0.372), 0.027, INK)
        art.disc((x, 0.372), 0.012, YELLOW)
    art.line([(0.64, 0.403), (0.83, 0.403)], 0.005, GREY)


def _graph(art: Transfer) -> None:
    nodes = {
        "/camera": (0.14, 0.535, 0.31, 0.59, YELLOW),
        "/features": (0.40, 0.515, 0.60, 0.57, PAPER),
        "/matcher": (0.405, 0.61, 0.595, 0.665, TEAL),
        "/pilot": (0.69, 0.555, 0.84, 0.615, ORANGE),
    }
    for name, (x0, y0, x1, y1, fill) in nodes.items():
        art.box((x0, y0, x1, y1), fill, width=0.006, radius=0.02)
        ink = PAPER if fill == TEAL else INK
        art.text((x0 + 0.018, y1 - 0.018), name, 0.031, ink, "DejaVuSansMono-Bold")
    art.arrow((0.315, 0.555), (0.395, 0.543))
    art.arrow((0.50, 0.575), (0.50, 0.607), RED)
    art.arrow((0.60, 0.638), (0.685, 0.595))
    art.arrow((0.605, 0.54), (0.685, 0.57), TEAL)
    art.gear((0.215, 0.64), 0.036, 10, RED)
    art.gear((0.283, 0.648), 0.027, 8, TEAL, 0.5)
    art.text((0.68, 0.668), "10 Hz", 0.032, RED, "DejaVuSansMono-Bold")


def _margins(art: Transfer) -> None:
    """Ornaments near the ends of the transfer, seen when the mug is turned."""
    art.gear((0.062, 0.10), 0.04, 9, ORANGE, 0.2)
    art.gear((0.055, 0.185), 0.028, 7, GREY, 0.4)
    art.arrow((0.06, 0.24), (0.06, 0.35), TEAL, 0.008)
    art.disc((0.06, 0.39), 0.024, YELLOW, INK, 0.005)
    art.arrow((0.06, 0.42), (0.06, 0.52), RED, 0.008)
    art.box((0.03, 0.54, 0.09, 0.6), TEAL, radius=0.006)
    art.line([(0.045, 0.57), (0.06, 0.585), (0.078, 0.555)], 0.008, PAPER)
    art.polygon([(0.94, 0.06), (0.975, 0.12), (0.905, 0.12)], YELLOW, INK)
    art.line([(0.94, 0.08), (0.94, 0.1)], 0.006)
    art.gear((0.938, 0.27), 0.044, 11, TEAL, 0.3)
    art.gear((0.925, 0.36), 0.03, 8, RED, 0.1)
    art.arrow((0.94, 0.40), (0.94, 0.50), INK, 0.008)
    art.disc((0.94, 0.545), 0.03, ORANGE, INK, 0.005)
    art.line([(0.922, 0.545), (0.958, 0.545)], 0.006)
    art.text((0.905, 0.635), "v1.0", 0.032, INK, "DejaVuSansMono-Bold")


def draw_print(width: int = 2048) -> np.ndarray:
    """Draw the whole print.

    Parameters
    ----------
    width : int
        Width in pixels.

    Returns
    -------
    numpy.ndarray
        RGB uint8 of shape (round(width / ASPECT), width, 3), white where there is no ink.
    """
    art = Transfer(width)
    _words(art)
    _robot(art)
    _graph(art)
    _margins(art)
    return art.finish()
