import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from course_lib import hamming

pytestmark = pytest.mark.skipif(
    not hasattr(np, "bitwise_count"), reason="NumPy 1 does not count bits"
)


def opencv(query, train):
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(query, train)
    return [(m.queryIdx, m.trainIdx, int(m.distance)) for m in matches]


def ours(query, train):
    return list(zip(*(a.tolist() for a in hamming.mutual_nearest(query, train)), strict=True))


@settings(max_examples=150, deadline=None)
@given(
    st.integers(1, 60),
    st.integers(1, 60),
    st.integers(1, 70),
    st.integers(1, 255),
    st.integers(0, 2**32 - 1),
)
def test_the_same_as_opencv_ties_included(n_query, n_train, length, variety, seed):
    # Few distinct bytes make many ties.
    rng = np.random.default_rng(seed)
    query = rng.integers(0, variety + 1, (n_query, length), dtype=np.uint8)
    train = rng.integers(0, variety + 1, (n_train, length), dtype=np.uint8)
    assert ours(query, train) == opencv(query, train)


def test_the_same_as_opencv_over_many_blocks():
    rng = np.random.default_rng(0)
    query = rng.integers(0, 256, (700, 32), dtype=np.uint8)
    train = np.concatenate([query[::3], rng.integers(0, 256, (900, 32), dtype=np.uint8)])
    train ^= (rng.random(train.shape) < 0.05).astype(np.uint8)
    assert ours(query, train) == opencv(query, train)
    assert len(ours(query, train)) > 233


def test_only_few_cores_prefer_it():
    rows = np.zeros((4, 32), np.uint8)
    before = cv2.getNumThreads()
    try:
        cv2.setNumThreads(2)
        assert hamming.available(rows, rows)
        cv2.setNumThreads(8)
        assert not hamming.available(rows, rows) or cv2.getNumThreads() <= 3
    finally:
        cv2.setNumThreads(before)
    assert not hamming.available(rows, np.zeros((1 << 16, 32), np.uint8))
