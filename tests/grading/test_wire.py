"""Plain data crosses whole; what a stranger makes up is refused."""

from __future__ import annotations

import json
import math

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from course_lib.grading import wire

DTYPES = ["bool", "uint8", "int32", "int64", "float16", "float32", "float64"]
SCALARS = st.none() | st.booleans() | st.integers(-(2**62), 2**62) | st.text(max_size=20)
VALUES = st.recursive(
    SCALARS | st.binary(max_size=20),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.lists(inner, max_size=4).map(tuple)
        | st.dictionaries(st.text(max_size=5), inner, max_size=3)
    ),
    max_leaves=20,
)
JSON = st.recursive(
    SCALARS | st.floats(),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from(["t", "v", "b", "d", "s", "one"]), inner)
        | st.fixed_dictionaries(
            {"t": st.sampled_from(["array", "list", "dict", "keypoints", "matches", "float"])},
            optional=dict.fromkeys("vbds", inner),
        )
    ),
    max_leaves=20,
)


def there_and_back(value: object) -> object:
    tree, buffers = wire.encode(value)
    return wire.decode(json.loads(json.dumps(tree)), buffers)


@given(VALUES)
def test_plain_values_cross_whole(value: object) -> None:
    surrogates = str(value).encode("utf-8", "replace").decode() != str(value)
    crossed = there_and_back(value)
    assert surrogates or crossed == value
    assert type(crossed) is type(value)


@given(
    st.sampled_from(DTYPES).flatmap(
        lambda dtype: npst.arrays(dtype, npst.array_shapes(min_dims=0, max_dims=4, min_side=0))
    )
)
def test_arrays_cross_bit_for_bit(array: np.ndarray) -> None:
    crossed = there_and_back(array)
    assert isinstance(crossed, np.ndarray)
    assert (crossed.dtype, crossed.shape) == (array.dtype, array.shape)
    assert crossed.tobytes() == array.tobytes()


def test_odd_memory_layouts_cross() -> None:
    array = np.arange(24, dtype=">i4").reshape(4, 6)[::2, ::-1].T
    np.testing.assert_array_equal(there_and_back(array), array)


def test_keypoints_and_matches_cross_as_opencv_objects() -> None:
    keypoints = [cv2.KeyPoint(1.5, 2.5, 31, 90, 0.25, 3, 7), cv2.KeyPoint(3, 4, 5)]
    matches = [[cv2.DMatch(1, 2, 0, 12.5)], [cv2.DMatch(3, 4, 0, 1.0)]]
    crossed = there_and_back((keypoints, matches))
    assert [k.pt for k in crossed[0]] == [(1.5, 2.5), (3, 4)]
    assert (crossed[0][0].octave, crossed[0][0].class_id) == (3, 7)
    assert [(m.queryIdx, m.trainIdx, m.distance) for [m] in crossed[1]] == [(1, 2, 12.5), (3, 4, 1)]


def test_an_array_of_keypoints_or_matches_is_a_list_of_them() -> None:
    made = [cv2.KeyPoint(1, 2, 3), cv2.KeyPoint(4, 5, 6)], [cv2.DMatch(1, 2, 0.5)]
    crossed = there_and_back([np.array(each, dtype=object) for each in made])
    assert [[type(item) for item in each] for each in crossed] == [
        [cv2.KeyPoint, cv2.KeyPoint],
        [cv2.DMatch],
    ]


@pytest.mark.parametrize("value", [math.inf, -math.inf, math.nan])
def test_numbers_that_json_lacks_cross(value: float) -> None:
    assert repr(there_and_back(value)) == repr(value)


class Posing(np.ndarray):
    """An array whose attributes lie."""

    @property
    def nbytes(self) -> int:  # type: ignore[override]
        return 0

    def __array_finalize__(self, other: object) -> None:
        self.extra = "payload"


def test_an_object_posing_as_an_array_arrives_as_its_numbers_alone() -> None:
    crossed = there_and_back(np.arange(4.0).view(Posing))
    assert type(crossed) is np.ndarray
    assert not hasattr(crossed, "extra")


@pytest.mark.parametrize("value", [object(), {1, 2}, np.array([object()]), lambda: None, 1 << 80])
def test_other_objects_arrive_as_the_name_of_their_type(value: object) -> None:
    assert isinstance(there_and_back(value), wire.Unknown)


def nested(depth: int) -> list:
    value: list = []
    for _ in range(depth):
        value = [value]
    return value


@pytest.mark.parametrize(
    "value",
    [
        np.zeros(wire.MOST_BYTES + 1, np.uint8),
        "x" * (wire.MOST_TEXT + 1),
        [0] * 300_000,
        nested(50),
    ],
    ids=["bytes", "text", "parts", "depth"],
)
def test_a_value_over_a_limit_is_refused_by_name(value: object) -> None:
    with pytest.raises(wire.BadDataError, match=r"value|array|text"):
        wire.encode(value)


@given(JSON, st.lists(st.binary(max_size=64), max_size=3))
def test_what_a_stranger_makes_up_is_a_value_or_refused(tree: object, buffers: list) -> None:
    try:
        wire.decode(tree, buffers)
    except wire.BadDataError:
        return


@pytest.mark.parametrize(
    "tree",
    [
        {"t": "array", "d": "object", "s": [1], "b": 0},
        {"t": "array", "d": "uint8", "s": [10**9, 10**9, 10**9], "b": 0},
        {"t": "array", "d": "uint8", "s": [-1, -8], "b": 0},
        {"t": "array", "d": "uint8", "s": [True, 8], "b": 0},
        {"t": "array", "d": "uint8", "s": [8], "b": -1},
        {"t": "keypoints", "b": 0},
        {"t": "dict", "v": [[{"t": "list", "v": []}, 1]]},
        {"t": "__reduce__", "v": "os.system"},
        {"t": "list", "v": [2**63]},
        {"t": "tuple", "v": [-(10**400)]},
        {"no": "type"},
    ],
)
def test_forged_descriptions_are_refused(tree: object) -> None:
    with pytest.raises(wire.BadDataError):
        wire.decode(tree, [b"12345678"])


def test_a_buffer_named_many_times_counts_many_times() -> None:
    data = bytes(wire.MOST_BYTES // 4)
    tree = {"t": "array", "d": "uint8", "s": [len(data)], "b": 0}
    assert len(wire.decode({"t": "list", "v": [tree] * 4}, [data])) == 4
    for forged in (tree, {"t": "bytes", "b": 0}):
        with pytest.raises(wire.BadDataError, match="too many bytes"):
            wire.decode({"t": "list", "v": [forged] * 5}, [data])


def test_forged_truth_values_are_true_or_false() -> None:
    found = wire.decode({"t": "array", "d": "bool", "s": [3], "b": 0}, [b"\x00\x01\xff"])
    assert found.tobytes() == b"\x00\x01\x01"
