import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from course_lib import hamming
from course_lib.matching import match_brute_force


def descriptors(seed, count, kind="binary"):
    rng = np.random.default_rng(seed)
    if kind == "binary":
        return rng.integers(0, 256, (count, 32), dtype=np.uint8)
    return rng.normal(0, 1, (count, 128)).astype(np.float32)


def as_tuples(matches):
    return [(m.queryIdx, m.trainIdx, m.distance) for m in matches]


@pytest.mark.parametrize("kind", ["binary", "float"])
@pytest.mark.parametrize("cross_check", [True, False])
@pytest.mark.parametrize("quick", [True, False])
def test_the_same_as_opencv_sorted(kind, cross_check, quick, monkeypatch):
    if not quick:
        monkeypatch.setattr(hamming, "available", lambda *_: False)
    query, train = descriptors(0, 120, kind), descriptors(1, 150, kind)
    norm = cv2.NORM_HAMMING if kind == "binary" else cv2.NORM_L2
    expected = cv2.BFMatcher(norm, crossCheck=cross_check).match(query, train)
    expected = sorted(expected, key=lambda match: match.distance)
    assert as_tuples(match_brute_force(query, train, cross_check=cross_check)) == as_tuples(
        expected
    )


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 40), st.integers(0, 40), st.integers(0, 10**6), st.sampled_from([None, 0.8]))
def test_cross_checked_matches_are_mutual_and_sorted(n_query, n_train, seed, ratio):
    rng = np.random.default_rng(seed)
    query = rng.integers(0, 4, (n_query, 2), dtype=np.uint8)
    train = rng.integers(0, 4, (n_train, 2), dtype=np.uint8)
    matches = match_brute_force(query, train, ratio=ratio)
    bits = np.unpackbits(query[:, None] ^ train[None], axis=2).sum(axis=2)
    assert [m.distance for m in matches] == sorted(m.distance for m in matches)
    assert len({m.trainIdx for m in matches}) == len({m.queryIdx for m in matches}) == len(matches)
    for match in matches:
        assert match.distance == bits[match.queryIdx].min() == bits[:, match.trainIdx].min()
        if ratio and n_train > 1:
            second = np.sort(bits[match.queryIdx])[1]
            assert match.distance < ratio * second


def test_ratio_without_cross_check():
    train = np.array([[0], [0b1111]], np.uint8)
    query = np.array([[0b0001], [0b0011]], np.uint8)
    kept = match_brute_force(query, train, cross_check=False, ratio=0.7)
    assert as_tuples(kept) == [(0, 0, 1.0)]


def test_a_sole_train_descriptor_has_no_rival():
    query, train = descriptors(0, 3), descriptors(1, 1)
    assert len(match_brute_force(query, train, cross_check=False, ratio=0.7)) == 3
    assert len(match_brute_force(query, train, ratio=0.7)) == 1


@pytest.mark.parametrize("empty", [None, np.empty((0, 32), np.uint8), np.empty(0, np.uint8)])
def test_no_descriptors_no_matches(empty):
    some = descriptors(0, 5)
    assert match_brute_force(empty, some) == []
    assert match_brute_force(some, empty) == []
    assert match_brute_force(empty, empty) == []


def test_norm_can_be_chosen():
    query, train = descriptors(0, 40), descriptors(1, 40)
    expected = cv2.BFMatcher(cv2.NORM_HAMMING2, crossCheck=True).match(query, train)
    found = match_brute_force(query, train, norm=cv2.NORM_HAMMING2)
    assert sorted(as_tuples(found)) == sorted(as_tuples(expected))


@pytest.mark.parametrize(
    ("query", "train", "options", "error", "message"),
    [
        ([1, 2], descriptors(0, 2), {}, TypeError, "query must be an array.*list"),
        (descriptors(0, 2), (), {}, TypeError, "train must be an array.*tuple"),
        (descriptors(0, 2).astype(float), descriptors(0, 2), {}, TypeError, "query must be uint8"),
        (descriptors(0, 2), descriptors(0, 2, "float"), {}, TypeError, "two different detectors"),
        (descriptors(0, 2), descriptors(0, 2)[:, :16], {}, ValueError, "32 long, train .* 16"),
        (
            descriptors(0, 2)[0],
            descriptors(0, 2),
            {},
            ValueError,
            r"query must have shape \(N, D\)",
        ),
        (descriptors(0, 2), descriptors(0, 2), {"ratio": 0}, ValueError, "ratio must be above 0"),
        (descriptors(0, 2), np.zeros((1 << 18, 1), np.uint8), {}, ValueError, "up to 262143"),
    ],
)
def test_wrong_descriptors_are_named(query, train, options, error, message):
    with pytest.raises(error, match=message):
        match_brute_force(query, train, **options)
