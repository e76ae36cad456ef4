import base64
import io

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import PIL.Image
import pytest
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output
from scenery import photographed, texture

from course_lib import display, drawing

mpl.use("Agg")
GREY = np.zeros((9, 9), np.uint8)


@pytest.fixture(scope="module", autouse=True)
def _shell():
    """A real IPython shell, so that display() publishes."""
    InteractiveShell.instance()
    yield
    InteractiveShell.clear_instance()


def photo(width=640, height=480):
    rng = np.random.default_rng(0)
    return photographed(rng, texture(rng, (width, height)), noise=8)


def shown(*args, **kwargs):
    with capture_output() as captured:
        display.show(*args, **kwargs)
    (output,) = captured.outputs
    return output


def decoded(output):
    return PIL.Image.open(io.BytesIO(base64.b64decode(output.data["image/png"])))


def test_one_output_with_its_text_alternative():
    output = shown(photo(), alt="Peppers on a table")
    assert set(output.data) == {"image/png", "text/plain"}
    assert output.data["text/plain"] == "Peppers on a table"
    assert output.metadata["image/png"]["alt"] == "Peppers on a table"
    assert output.metadata["image/png"]["width"] == 640


def test_colours_are_rgb_in_the_png():
    blue = np.zeros((20, 30, 3), np.uint8)
    blue[..., 0] = 255
    assert decoded(shown(blue, alt="blue")).convert("RGB").getpixel((3, 3)) == (0, 0, 255)


@pytest.mark.parametrize("size", [(640, 480), (1280, 480), (2000, 1500)])
def test_photographs_stay_small(size):
    data = base64.b64decode(shown(photo(*size), alt="noise").data["image/png"])
    assert len(data) <= display.MAX_BYTES
    assert PIL.Image.open(io.BytesIO(data)).width >= 400


def test_a_drawing_keeps_its_pixels():
    picture = np.full((300, 400, 3), 200, np.uint8)
    picture[100:200, 50:80] = (10, 20, 30)
    again = np.asarray(decoded(shown(picture, alt="bar")).convert("RGB"))[:, :, ::-1]
    assert np.array_equal(again, picture)


def test_several_side_by_side_with_captions_and_title():
    parts = [np.zeros((50, 80, 3), np.uint8), np.zeros((90, 60), np.uint8)]
    plain = decoded(shown(parts, alt="two"))
    assert plain.size == (80 + 60 + display.GAP, 90)
    titled = decoded(shown(parts, alt="two", title="Both", captions=["left", "right"]))
    assert titled.height == 90 + 4 * display.CAPTION_SIZE
    assert 74 <= decoded(shown(parts, alt="two", width=76)).width <= 76


def test_captions_are_not_shrunk_with_the_pictures():
    parts = [np.full((200, 300, 3), 90, np.uint8)] * 2
    sheet = decoded(shown(parts, alt="two", width=180, captions=["left", "right"]))
    assert sheet.height == 200 * 84 // 300 + 2 * display.CAPTION_SIZE


def test_width_in_the_metadata_is_that_of_the_output():
    output = shown(photo(), alt="small", width=300)
    assert decoded(output).width == output.metadata["image/png"]["width"] == 300


@pytest.mark.parametrize(
    ("kwargs", "error", "message"),
    [
        ({"image": GREY, "alt": ""}, ValueError, "alt must say"),
        ({"image": GREY, "alt": None}, ValueError, "alt must say"),
        ({"image": [], "alt": "x"}, ValueError, "empty sequence"),
        ({"image": [GREY], "alt": "x", "captions": ["a", "b"]}, ValueError, "1 pictures need"),
        ({"image": [None], "alt": "x"}, TypeError, "image is None"),
        ({"image": GREY, "alt": "x", "width": 0}, ValueError, "width must be at least 1"),
    ],
)
def test_wrong_arguments_are_named(kwargs, error, message):
    with pytest.raises(error, match=message):
        display.show(**kwargs)


def test_plot_publishes_and_closes():
    figure, axes = plt.subplots(figsize=(6, 4))
    axes.plot([1, 4, 2])
    with capture_output() as captured:
        drawing.plot(figure, alt="A line that rises and falls")
    (output,) = captured.outputs
    assert output.data["text/plain"] == "A line that rises and falls"
    assert decoded(output).width > 300
    assert not plt.fignum_exists(figure.number)


def test_encode_png_limits_width_and_bytes():
    data = display.encode_png(photo(), max_width=320, max_bytes=30_000)
    assert len(data) <= 30_000
    assert PIL.Image.open(io.BytesIO(data)).width <= 320


def test_columns_break_the_row():
    tiles = [np.full((20, 30, 3), 40 * i, np.uint8) for i in range(5)]
    sheet = decoded(shown(tiles, alt="tiles", columns=2))
    assert sheet.size == (2 * 30 + display.GAP, 3 * 20 + 2 * display.GAP)
