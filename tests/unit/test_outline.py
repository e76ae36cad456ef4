import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scenery import SCENE_SIZE, TEMPLATE_SIZE, corners_of, view

from course_lib.homography import project, template_corners
from course_lib.outline import outline_fault


def fault(H):
    return outline_fault(np.asarray(H, float), TEMPLATE_SIZE, SCENE_SIZE)


@given(st.integers(0, 10**6), st.floats(0, 0.8), st.floats(0.2, 2))
def test_a_cameras_view_is_never_at_fault(seed, tilt, scale):
    H = view(np.random.default_rng(seed), tilt=tilt, scale=scale)
    outline = corners_of(H)
    inside = (outline > 0).all(axis=1) & (outline < SCENE_SIZE).all(axis=1)
    assume(inside.sum() >= 2)
    assert fault(H) is None


@pytest.mark.parametrize(
    ("H", "word"),
    [
        ([[-1, 0, 500], [0, 1, 50], [0, 0, 1]], "mirrored"),
        ([[1, 0, 0], [0, 1, 0], [-0.005, 0, 1]], "behind the camera"),
        ([[0.01, 0, 100], [0, 0.01, 100], [0, 0, 1]], "degenerate"),
        ([[0.02, 0, 100], [0, 0.021, 100], [0, 0, 1]], "absurd area"),
        ([[16, 0, 0], [0, 16, 0], [0, 0, 1]], "absurd area"),
        ([[1, 0, 5000], [0, 1, 0], [0, 0, 1]], "absurd place"),
        ([[1, 0, 0], [0, 1, 0], [0.01, 0, 1]], "absurd perspective"),
        ([[1, 1, 0], [0.95, 1, 0], [0, 0, 1]], "edge-on"),
        ([[0, 0, 9], [0, 0, 9], [0, 0, 1]], "folded"),
    ],
)
def test_each_fault_has_its_word(H, word):
    found = fault(H)
    assert found
    assert word in found


@given(
    hnp.arrays(np.float64, (3, 3), elements=st.floats(-5, 5)),
    st.floats(1, 600),
)
def test_whatever_passes_is_a_proper_outline(H, spread):
    H = H * np.array([[1, 1, spread], [1, 1, spread], [1e-3, 1e-3, 0]])
    H[2, 2] = 1
    if fault(H):
        return
    outline = project(H, template_corners(TEMPLATE_SIZE))
    sides = np.roll(outline, -1, axis=0) - outline
    following = np.roll(sides, -1, axis=0)
    turns = sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0]
    assert (turns < 0).all()
    assert np.isfinite(outline).all()
