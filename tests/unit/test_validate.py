import numpy as np
import pytest

from course_lib._validate import as_bgr, as_corners, as_count, as_grey, as_image


def test_a_good_picture_is_not_copied():
    picture = np.zeros((4, 5, 3), np.uint8)
    assert as_image(picture, "image") is picture


def test_every_form_becomes_uint8():
    ramp = np.arange(0, 250, 10, dtype=np.uint8).reshape(5, 5)
    assert np.array_equal(as_image(ramp / 255, "image"), ramp)
    assert np.array_equal(as_image((ramp / 255).astype(np.float32), "image"), ramp)
    assert np.array_equal(as_image(ramp.astype(np.float64), "image"), ramp)
    assert np.array_equal(as_image(ramp.astype(np.float16), "image"), ramp)
    assert as_image(ramp > 100, "image").tolist() == ((ramp > 100) * 255).tolist()
    assert as_image(ramp[:, :, None], "image").shape == (5, 5)
    assert as_image(np.dstack([ramp] * 4), "image").shape == (5, 5, 3)
    assert as_image(ramp.T, "image").flags.c_contiguous


def test_floats_are_rounded_not_cut():
    assert as_image(np.array([[9.6, 200.4]]), "image").tolist() == [[10, 200]]


def test_grey_takes_the_order_bgr():
    blue = np.zeros((1, 1, 3), np.uint8)
    blue[..., 0] = 255
    assert as_grey(blue, "image")[0, 0] == 29
    assert as_grey(blue[:, :, ::-1], "image")[0, 0] == 76


def test_bgr_is_a_copy_to_draw_upon():
    picture = np.zeros((4, 5, 3), np.uint8)
    as_bgr(picture, "image")[:] = 9
    assert picture.max() == 0
    assert as_bgr(np.zeros((4, 5), np.uint8), "image").shape == (4, 5, 3)


@pytest.mark.parametrize(
    ("image", "error", "message"),
    [
        (None, TypeError, "frame is None.*imread"),
        ([[1, 2]], TypeError, "frame must be a NumPy array, got list"),
        (np.zeros((2, 2), np.uint16), TypeError, "frame must be uint8.*uint16.*divide by 256"),
        (np.zeros((2, 2), np.int64), TypeError, "frame must be uint8.*int64"),
        (np.zeros((2, 2), complex), TypeError, "frame must be uint8"),
        (np.array([["a"]]), TypeError, "frame must be uint8"),
        (np.zeros(5, np.uint8), ValueError, r"frame must be grey .*\(5,\)"),
        (np.zeros((5, 5, 2), np.uint8), ValueError, r"frame must be grey .*\(5, 5, 2\)"),
        (np.zeros((2, 5, 5, 3), np.uint8), ValueError, "frame must be grey"),
        (np.zeros((0, 5, 3), np.uint8), ValueError, "frame is empty"),
        (np.zeros((1, 40000), np.uint8), ValueError, "frame is 40000 x 1 .*32767"),
        (np.full((2, 2), np.nan), ValueError, "frame holds NaN"),
        (np.array([[0, np.inf]]), ValueError, "frame holds NaN or infinity"),
        (np.array([[0, 300.0]]), ValueError, "frame is float with values 0..300"),
        (np.array([[-0.5, 1.0]]), ValueError, "frame is float with values -0.5..1"),
    ],
)
def test_wrong_pictures_are_named(image, error, message):
    with pytest.raises(error, match=message):
        as_image(image, "frame")


def test_corners():
    square = [[0, 0], [0, 1], [1, 1], [1, 0]]
    assert as_corners(square, "outline").shape == (4, 2)
    assert as_corners(np.array(square)[:, None], "outline").shape == (4, 2)
    with pytest.raises(ValueError, match=r"outline must have shape \(4, 2\), got \(3, 2\)"):
        as_corners(square[:3], "outline")
    with pytest.raises(ValueError, match="outline holds NaN"):
        as_corners([[np.nan, 0]] * 4, "outline")


def test_counts():
    assert as_count(np.int32(7), "width", 1) == 7
    for wrong in (1.0, True, "3", None):
        with pytest.raises(TypeError, match="width must be a whole number"):
            as_count(wrong, "width", 1)
    with pytest.raises(ValueError, match="width must be at least 1, got 0"):
        as_count(0, "width", 1)
