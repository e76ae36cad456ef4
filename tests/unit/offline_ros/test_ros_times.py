"""Times and durations, with the results that genpy gives."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_lib.offline_ros.exceptions import ROSInitException
from course_lib.offline_ros.times import Duration, Time

T, D = Time, Duration
NSEC = st.integers(0, 2**31 * 10**9)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (T(5) - T(3), D(2)),
        (T(3) - T(5), D(-2)),
        (T(5) - D(3), T(2)),
        (T(5) + D(1.5), T(6, 500_000_000)),
        (D(1.5) + T(5), T(6, 500_000_000)),
        (D(1.5) - D(2), D(-0.5)),
        (D(3) / 2, D(1.5)),
        (D(3) / D(2), 1.5),
        (D(3) // 2, D(1)),
        (D(3) // D(2), 1),
        (D(3) % D(2), D(1)),
        (0.5 * D(3), D(1.5)),
        (D(3) * 2, D(6)),
        (-D(1.5), D(-2, 500_000_000)),
        (abs(D(-1.5)), D(1.5)),
        (T(1, 1_500_000_000), T(2, 500_000_000)),
        (T(1.25).to_sec(), 1.25),
        (T.from_sec(2.5), T(2.5)),
        (str(T(1, 5)), "1000000005"),
        (repr(D(1)), "rospy.Duration[1000000000]"),
        (T(3) == D(3), False),
        (bool(T()), False),
    ],
)
def test_arithmetic(value: object, expected: object) -> None:
    assert value == expected
    assert type(value) is type(expected)


@pytest.mark.parametrize(
    "mistake",
    [
        lambda: T(3) + T(3),
        lambda: T(3) > D(3),
        lambda: T(5) + 5,
        lambda: D(5) - 1,
        lambda: D(3) - T(1),
        lambda: D(5) % 2,
        lambda: T(2) * 2,
        lambda: T(-1),
    ],
)
def test_nonsense_is_refused(mistake: object) -> None:
    with pytest.raises(TypeError):
        mistake()  # type: ignore[operator]


@given(NSEC, NSEC)
def test_exact_to_the_nanosecond(first: int, second: int) -> None:
    a, b = T.from_nsec(first), T.from_nsec(second)
    assert (a - b).to_nsec() == first - second
    assert b + (a - b) == a
    assert (a < b) == (first < second)
    assert (hash(a) == hash(b)) == (first == second)
    assert 0 <= (a - b).nsecs < 10**9


def test_no_time_before_a_node_runs() -> None:
    with pytest.raises(ROSInitException, match="Have you called init_node"):
        T.now()
