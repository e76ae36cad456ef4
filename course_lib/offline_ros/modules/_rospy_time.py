"""Waiting and timers of `rospy`, on simulated time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_lib.offline_ros.exceptions import ROSInitException, ROSInterruptException
from course_lib.offline_ros.modules import get_runtime
from course_lib.offline_ros.times import Duration, Time

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_lib.offline_ros.runtime import Runtime


def _running() -> Runtime:
    runtime = get_runtime()
    if not runtime.initialized:
        msg = "time is not initialized. Have you called init_node()?"
        raise ROSInitException(msg)
    return runtime


def _wait(runtime: Runtime, deadline_ns: int) -> None:
    if not runtime.reason:
        runtime.run_until(deadline_ns)
    if runtime.reason:
        msg = "ROS shutdown request"
        raise ROSInterruptException(msg)


def sleep(duration: Duration | float) -> None:
    """Let simulated time pass; messages are delivered meanwhile.

    Parameters
    ----------
    duration : Duration or float
        How long, in seconds.

    Raises
    ------
    ROSInterruptException
        When the node is shut down before.
    """
    runtime = _running()
    nanoseconds = duration.to_nsec() if isinstance(duration, Duration) else int(duration * 1e9)
    _wait(runtime, runtime.now_ns() + max(nanoseconds, 0))


def get_time() -> float:
    """Give the simulated time in seconds."""
    return _running().now_ns() / 1e9


def get_rostime() -> Time:
    """Give the simulated time."""
    _running()
    return Time.now()


class Rate:
    """Keeps a loop at a steady rate.

    Parameters
    ----------
    hz : float
        Loops per second of simulated time.
    reset : bool, optional
        Accepted as in `rospy`; simulated time never jumps back.
    """

    def __init__(self, hz: float, reset: bool = False) -> None:  # noqa: FBT001, FBT002  (rospy's)
        _ = reset
        if hz <= 0:
            msg = f"a rate must be positive, not {hz}"
            raise ValueError(msg)
        self.sleep_dur = Duration.from_nsec(round(1e9 / hz))
        self.last_time = get_rostime()

    def remaining(self) -> Duration:
        """Give the time left in this round."""
        left: Duration = self.sleep_dur - (get_rostime() - self.last_time)
        return left

    def sleep(self) -> None:
        """Wait for the end of this round.

        Raises
        ------
        ROSInterruptException
            When the node is shut down before.
        """
        runtime = _running()
        target = self.last_time + self.sleep_dur
        _wait(runtime, max(target.to_nsec(), runtime.now_ns()))
        now = get_rostime()
        # A loop that is more than one round late starts afresh instead of hurrying.
        late = now.to_nsec() - target.to_nsec() > self.sleep_dur.to_nsec()
        self.last_time = now if late else target


@dataclass
class TimerEvent:
    """What a timer's callback is told (times are simulated)."""

    last_expected: Time | None
    last_real: Time | None
    current_expected: Time
    current_real: Time
    last_duration: float | None


class Timer:
    """Calls back again and again, or once.

    Parameters
    ----------
    period : Duration
        Time between calls.
    callback : callable
        Takes a `TimerEvent`.
    oneshot : bool, optional
        Call once only.
    reset : bool, optional
        Accepted as in `rospy`; simulated time never jumps back.
    """

    def __init__(
        self,
        period: Duration,
        callback: Callable[[TimerEvent], None],
        oneshot: bool = False,  # noqa: FBT001, FBT002  (rospy's)
        reset: bool = False,  # noqa: FBT001, FBT002
    ) -> None:
        _ = reset
        if period.to_nsec() <= 0:
            msg = f"a timer's period must be positive, not {period.to_sec()} s"
            raise ValueError(msg)
        self._period = period
        self._callback = callback
        self._oneshot = oneshot
        self._alive = True
        self._busy = False
        self._last: tuple[Time, Time] | None = None
        self._arm(_running().now_ns() + period.to_nsec())

    def _arm(self, stamp_ns: int) -> None:
        get_runtime().at(stamp_ns, lambda: self._fire(Time.from_nsec(stamp_ns)))

    def _fire(self, expected: Time) -> None:
        if not self._alive:
            return
        now = get_rostime()
        if not self._oneshot:
            # In wall clock mode a busy node may be several periods late: those are skipped.
            missed = (now.to_nsec() - expected.to_nsec()) // self._period.to_nsec()
            self._arm(expected.to_nsec() + (missed + 1) * self._period.to_nsec())
        if self._busy:
            return
        last_expected, last_real = self._last or (None, None)
        self._last = (expected, now)
        duration = None if last_expected is None else 0.0
        event = TimerEvent(last_expected, last_real, expected, now, duration)
        self._busy = True
        try:
            get_runtime().call(self._callback, event)
        finally:
            self._busy = False

    def shutdown(self) -> None:
        """Stop the timer."""
        self._alive = False

    def is_alive(self) -> bool:
        """Tell whether the timer still runs."""
        return self._alive

    def join(self, timeout: float | None = None) -> None:
        """Return at once: a timer has no thread here."""
