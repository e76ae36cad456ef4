import cv2
import numpy as np
import pytest

from course_lib import drawing
from course_lib.localize import Detection

GREY = np.full((100, 140), 128, np.uint8)
SQUARE = np.array([[30, 20], [30, 70], [90, 70], [90, 20]], np.float32)


def inked(pixel, ink):
    """Anti-aliasing leaves a little of the background in a thin line."""
    return np.abs(pixel.astype(int) - ink).max() < 20


def marked(picture, background=128):
    return np.argwhere((picture != background).any(axis=2))


def test_keypoints_show_place_size_and_angle():
    keypoint = cv2.KeyPoint(50.0, 40.0, 24.0, 90.0)
    drawn = drawing.draw_keypoints(GREY, [keypoint])
    assert drawn.shape == (100, 140, 3)
    spots = marked(drawn)
    assert np.allclose(spots.mean(axis=0), [40, 50], atol=3)
    assert np.abs(spots - [40, 50]).max() in (13, 14, 15)
    # 90 degrees is clockwise on screen: the line runs down, not up.
    assert (drawn[46, 50] != 128).any()
    assert (drawn[34, 50] == 128).all()
    assert (GREY == 128).all()


def test_plain_keypoints_are_alike():
    keypoints = [cv2.KeyPoint(20.0, 20.0, 60.0, 10.0), cv2.KeyPoint(100.0, 70.0, 5.0, -1.0)]
    drawn = drawing.draw_keypoints(GREY, keypoints, rich=False, color=drawing.GREEN)
    patches = [drawn[y - 9 : y + 10, x - 9 : x + 10] for x, y in ((20, 20), (100, 70))]
    assert np.array_equal(*patches)


def test_no_keypoints_no_marks():
    assert (drawing.draw_keypoints(GREY, []) == 128).all()


@pytest.fixture
def matched():
    left = [cv2.KeyPoint(10.0, 50.0, 5), cv2.KeyPoint(70.0, 20.0, 5)]
    right = [cv2.KeyPoint(30.0, 50.0, 5), cv2.KeyPoint(40.0, 90.0, 5)]
    return left, right, [cv2.DMatch(0, 0, 1.0), cv2.DMatch(1, 1, 2.0)]


def test_matches_lie_between_the_pictures(matched):
    left, right, matches = matched
    tall = np.full((150, 80), 128, np.uint8)
    drawn = drawing.draw_matches(GREY, left, tall, right, matches)
    assert drawn.shape == (150, 220, 3)
    assert (drawn[120, 30] == 255).all()
    assert inked(drawn[50, 100], drawing.ORANGE)


def test_outliers_are_grey_or_left_out(matched):
    left, right, matches = matched
    scene = np.full((100, 80), 128, np.uint8)
    both = drawing.draw_matches(GREY, left, scene, right, matches, inliers=[True, False])
    inlier = drawing.draw_matches(
        GREY, left, scene, right, matches, inliers=[True, False], outliers=False
    )
    assert inked(both[50, 100], drawing.ORANGE)
    assert inked(both[20, 67], drawing.GREY)
    assert (inlier[20, 67] == 128).all()
    assert len(marked(inlier)) < len(marked(both))


def test_wrong_matches_are_named(matched):
    left, right, matches = matched
    with pytest.raises(ValueError, match="inliers has 1 entries for 2 matches"):
        drawing.draw_matches(GREY, left, GREY, right, matches, inliers=[True])
    with pytest.raises(ValueError, match="are template and scene swapped"):
        drawing.draw_matches(GREY, left, GREY, right[:1], matches)


@pytest.mark.parametrize("form", [SQUARE, SQUARE[:, None], SQUARE.tolist()])
def test_outline(form):
    drawn = drawing.draw_outline(GREY, form)
    assert inked(drawn[45, 30], drawing.GREEN)
    # The top edge has another colour.
    assert inked(drawn[20, 60], drawing.ORANGE)
    assert (drawn[45, 60] == 128).all()
    assert len(marked(drawing.draw_outline(GREY, form, label="box"))) > len(marked(drawn))


def test_outline_of_a_detection():
    found = Detection(found=True, reason="", corners=SQUARE, homography=np.eye(3))
    assert np.array_equal(drawing.draw_outline(GREY, found), drawing.draw_outline(GREY, SQUARE))
    for nothing in (Detection(found=False, reason="too few matches"), None):
        assert (drawing.draw_outline(GREY, nothing) == 128).all()


def test_outlines_far_outside_do_no_harm():
    drawing.draw_outline(GREY, SQUARE * 1e12)
    half = drawing.draw_outline(GREY, SQUARE - 50)
    assert len(marked(half)) > 0


def test_wrong_outlines_are_named():
    with pytest.raises(ValueError, match="outline must have shape"):
        drawing.draw_outline(GREY, SQUARE[:3])
    with pytest.raises(ValueError, match="outline holds NaN"):
        drawing.draw_outline(GREY, SQUARE * np.nan)
    with pytest.raises(TypeError, match="scene is None"):
        drawing.draw_outline(None, SQUARE)
