"""`rospy.Time` and `rospy.Duration`: whole seconds and nanoseconds, with exact arithmetic."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Self

from course_lib.offline_ros.exceptions import ROSInitException

if TYPE_CHECKING:
    from collections.abc import Callable

_BILLION = 1_000_000_000


class _Seconds:
    """What times and durations share. Mutable and unhashable parts are as in ROS 1."""

    __slots__ = ("nsecs", "secs")

    def __init__(self, secs: float = 0, nsecs: int = 0) -> None:
        if not isinstance(secs, int):
            # As ROS: the fraction of the seconds goes to the nanoseconds.
            if nsecs:
                msg = "give whole seconds and nanoseconds, or seconds as a float, not both"
                raise ValueError(msg)
            whole = int(secs)
            secs, nsecs = whole, int((secs - whole) * _BILLION)
        self.secs = secs
        self.nsecs = int(nsecs)
        self.canon()

    def canon(self) -> None:
        """Bring the nanoseconds into [0, 1e9)."""
        self._set_nsec(self.secs * _BILLION + self.nsecs)

    def _set_nsec(self, total: int) -> None:
        self.secs, self.nsecs = divmod(total, _BILLION)

    def set(self, secs: int, nsecs: int) -> None:
        """Set seconds and nanoseconds."""
        self._set_nsec(int(secs) * _BILLION + int(nsecs))

    @classmethod
    def from_sec(cls, float_secs: float) -> Self:
        """Make one from seconds as a float."""
        whole = int(float_secs)
        return cls(whole, int((float_secs - whole) * _BILLION))

    @classmethod
    def from_nsec(cls, nsec: int) -> Self:
        """Make one from nanoseconds (not in ROS 1; used inside this package)."""
        return cls(*divmod(int(nsec), _BILLION))

    from_seconds = from_sec

    def to_sec(self) -> float:
        """Give seconds as a float."""
        return self.secs + self.nsecs / _BILLION

    def to_nsec(self) -> int:
        """Give nanoseconds."""
        return self.secs * _BILLION + self.nsecs

    def is_zero(self) -> bool:
        """Tell whether it is zero."""
        return self.secs == 0 and self.nsecs == 0

    def __bool__(self) -> bool:
        return not self.is_zero()

    def __hash__(self) -> int:
        return hash((type(self).__name__, self.to_nsec()))

    def __eq__(self, other: object) -> bool:
        return self.to_nsec() == other.to_nsec() if isinstance(other, type(self)) else False

    def _other(self, other: object) -> int:
        if not isinstance(other, type(self)):
            msg = f"cannot compare a {type(self).__name__} with a {type(other).__name__}"
            raise TypeError(msg)
        return other.to_nsec()

    def __lt__(self, other: object) -> bool:
        return self.to_nsec() < self._other(other)

    def __le__(self, other: object) -> bool:
        return self.to_nsec() <= self._other(other)

    def __gt__(self, other: object) -> bool:
        return self.to_nsec() > self._other(other)

    def __ge__(self, other: object) -> bool:
        return self.to_nsec() >= self._other(other)

    def __str__(self) -> str:
        return str(self.to_nsec())

    def __repr__(self) -> str:
        return f"rospy.{type(self).__name__}[{self.to_nsec()}]"

    def __deepcopy__(self, memo: object) -> Self:
        return type(self)(self.secs, self.nsecs)


class Duration(_Seconds):
    """A span of time; may be negative."""

    __slots__ = ()

    def __neg__(self) -> Duration:
        return Duration.from_nsec(-self.to_nsec())

    def __abs__(self) -> Duration:
        return Duration.from_nsec(abs(self.to_nsec()))

    def __add__(self, other: object) -> Any:  # noqa: ANN401  (Duration or Time)
        if isinstance(other, (Duration, Time)):
            return type(other).from_nsec(self.to_nsec() + other.to_nsec())
        return NotImplemented

    def __sub__(self, other: object) -> Duration:
        if isinstance(other, Duration):
            return Duration.from_nsec(self.to_nsec() - other.to_nsec())
        return NotImplemented

    def __mul__(self, factor: object) -> Duration:
        if isinstance(factor, int):
            return Duration.from_nsec(self.to_nsec() * factor)
        if isinstance(factor, float):
            return Duration.from_sec(self.to_sec() * factor)
        return NotImplemented

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Any:  # noqa: ANN401  (float or Duration)
        if isinstance(other, Duration):
            return self.to_sec() / other.to_sec()
        if isinstance(other, (int, float)):
            return Duration.from_sec(self.to_sec() / other)
        return NotImplemented

    def __floordiv__(self, other: object) -> Any:  # noqa: ANN401  (int or Duration)
        if isinstance(other, Duration):
            return self.to_nsec() // other.to_nsec()
        if isinstance(other, (int, float)):
            return Duration.from_sec(self.to_sec() // other)
        return NotImplemented

    def __mod__(self, other: object) -> Duration:
        if isinstance(other, Duration):
            return Duration.from_nsec(self.to_nsec() % other.to_nsec())
        if isinstance(other, float):
            return Duration.from_sec(self.to_sec() % other)
        return NotImplemented


class Time(_Seconds):
    """A moment; `Time.now()` reads the simulated clock."""

    __slots__ = ()

    # Set by the runtime: the clock does not exist before a node runs.
    clock_ns: ClassVar[Callable[[], int] | None] = None

    def __init__(self, secs: float = 0, nsecs: int = 0) -> None:
        super().__init__(secs, nsecs)
        if self.secs < 0:
            msg = "a time must not be negative"
            raise TypeError(msg)

    @staticmethod
    def now() -> Time:
        """Give the current simulated time."""
        if Time.clock_ns is None:
            msg = "time is not initialized. Have you called init_node()?"
            raise ROSInitException(msg)
        return Time.from_nsec(Time.clock_ns())

    def to_time(self) -> float:
        """Give seconds since the epoch, as `time.time()` does."""
        return self.to_sec()

    def __add__(self, other: object) -> Time:
        if isinstance(other, Duration):
            return Time.from_nsec(self.to_nsec() + other.to_nsec())
        return NotImplemented

    __radd__ = __add__

    def __sub__(self, other: object) -> Any:  # noqa: ANN401  (Duration or Time)
        if isinstance(other, Time):
            return Duration.from_nsec(self.to_nsec() - other.to_nsec())
        if isinstance(other, Duration):
            return Time.from_nsec(self.to_nsec() - other.to_nsec())
        return NotImplemented
