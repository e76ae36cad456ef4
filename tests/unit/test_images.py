import json
import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from course_lib import images

PICTURE = np.dstack([np.full((20, 30), value, np.uint8) for value in (10, 120, 240)])


@pytest.fixture
def shelf(tmp_path, monkeypatch):
    """An images folder of our own."""
    (tmp_path / "truth").mkdir()
    (tmp_path / "heldout" / "truth").mkdir(parents=True)
    cv2.imwrite(str(tmp_path / "box.png"), PICTURE)
    cv2.imwrite(str(tmp_path / "box_in_scene.jpg"), PICTURE)
    alpha = np.dstack([PICTURE, np.full((20, 30), 77, np.uint8)])
    cv2.imwrite(str(tmp_path / "heldout" / "mug_1.png"), alpha)
    (tmp_path / "flight.bag").write_bytes(b"#ROSBAG V2.0\n")
    (tmp_path / "README.md").write_text("not a picture")
    (tmp_path / "truth" / "box.json").write_text(json.dumps({"size": [30, 20]}))
    (tmp_path / "truth" / "flight.json").write_text(json.dumps({"frames": []}))
    (tmp_path / "heldout" / "truth" / "mug_1.json").write_text(json.dumps({"image": "mug_1.png"}))
    monkeypatch.setenv("COURSE_IMAGES", str(tmp_path))
    return tmp_path


def test_loads_bgr(shelf):
    assert shelf
    picture = images.load("box.png")
    assert picture.dtype == np.uint8
    assert np.array_equal(picture, PICTURE)


def test_alpha_on_demand(shelf):
    assert shelf
    assert images.load("heldout/mug_1.png").shape == (20, 30, 3)
    with_alpha = images.load("heldout/mug_1.png", alpha=True)
    assert with_alpha.shape == (20, 30, 4)
    assert (with_alpha[:, :, 3] == 77).all()
    assert (images.load("box.png", alpha=True)[:, :, 3] == 255).all()


def test_grey_files_become_colour(shelf):
    cv2.imwrite(str(shelf / "grey.png"), PICTURE[:, :, 0])
    assert images.load("grey.png").shape == (20, 30, 3)
    assert images.load("grey.png", alpha=True).shape == (20, 30, 4)


def test_names(shelf):
    assert shelf
    assert images.names() == ["box.png", "box_in_scene.jpg"]
    assert images.names("heldout") == ["heldout/mug_1.png"]
    with pytest.raises(images.MissingImageError, match="No folder 'nothing'"):
        images.names("nothing")


@pytest.mark.parametrize(
    ("name", "hint"),
    [("box", "'box.png'"), ("bocks.png", "'box.png'"), ("box_in_scene.png", "'box_in_scene.jpg'")],
)
def test_missing_lists_what_exists(shelf, name, hint):
    assert shelf
    with pytest.raises(images.MissingImageError) as caught:
        images.load(name)
    assert f"Did you mean {hint}" in str(caught.value)
    assert "There is: box.png, box_in_scene.jpg, flight.bag" in str(caught.value)
    assert isinstance(caught.value, FileNotFoundError)


@pytest.mark.parametrize("content", [b"", b"\x89PNG\r\n\x1a\n broken", b"version https://git-lfs"])
def test_unreadable_is_told_apart_from_missing(shelf, content):
    (shelf / "broken.png").write_bytes(content)
    with pytest.raises(images.UnreadableImageError, match=rf"broken\.png exists \({len(content)}"):
        images.load("broken.png")


@pytest.mark.skipif(os.name == "nt", reason="a folder cannot be read as a file only on POSIX")
def test_a_folder_named_like_a_picture(shelf):
    (shelf / "folder.png").mkdir()
    with pytest.raises(images.UnreadableImageError, match="exists but cannot be read"):
        images.load("folder.png")


def test_a_flight_is_not_a_picture(shelf):
    assert images.path("flight.bag") == shelf / "flight.bag"
    with pytest.raises(images.UnreadableImageError, match="open_camera"):
        images.load("flight.bag")


@pytest.mark.parametrize("name", ["../secret.png", "/etc/passwd", "heldout/../../x.png"])
def test_names_stay_inside(shelf, name):
    assert shelf
    with pytest.raises(ValueError, match="inside the course's images"):
        images.load(name)


def test_truth(shelf):
    assert images.truth("box.png") == {"size": [30, 20]}
    assert images.truth("flight.bag") == {"frames": []}
    assert images.truth("heldout/mug_1.png") == {"image": "mug_1.png"}
    with pytest.raises(images.MissingImageError, match=r"record for 'box_in_scene\.jpg'"):
        images.truth("box_in_scene.jpg")
    with pytest.raises(images.MissingImageError, match=r"Did you mean 'box\.png'"):
        images.truth("bax.png")
    (shelf / "truth" / "box.json").write_text("{")
    with pytest.raises(images.UnreadableImageError, match=r"box\.json is not a readable"):
        images.truth("box.png")


def test_an_absent_folder_says_which_variable(monkeypatch, tmp_path):
    monkeypatch.setenv("COURSE_IMAGES", str(tmp_path / "gone"))
    with pytest.raises(images.MissingImageError, match="COURSE_IMAGES"):
        images.names()


def test_without_the_variable_it_is_beside_the_package(monkeypatch):
    monkeypatch.delenv("COURSE_IMAGES", raising=False)
    assert images.folder() == Path(images.__file__).resolve().parents[1] / "images"


def test_resize_is_width_then_height():
    assert images.resize(PICTURE, width=40, height=60).shape == (60, 40, 3)
    assert images.resize(PICTURE[:, :, 0], 4, 6).shape == (6, 4)


def test_shrinking_averages():
    stripes = np.tile(np.array([[0, 255]], np.uint8), (50, 50))
    assert np.unique(images.resize(stripes, 50, 25)).tolist() == [128]


@pytest.mark.parametrize(
    ("size", "error", "message"),
    [
        ((0, 5), ValueError, "width must be at least 1"),
        ((5, -1), ValueError, "height must be at least 1"),
        ((5.5, 5), TypeError, "width must be a whole number"),
        ((5, None), TypeError, "height must be a whole number"),
        ((40_000, 5), ValueError, "at most 32767"),
    ],
)
def test_wrong_sizes_are_named(size, error, message):
    with pytest.raises(error, match=message):
        images.resize(PICTURE, *size)


def test_wrong_picture_is_named():
    with pytest.raises(TypeError, match="image is None"):
        images.resize(None, 5, 5)
