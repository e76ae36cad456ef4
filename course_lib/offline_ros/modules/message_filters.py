"""`message_filters`: several topics brought together by their stamps."""

from __future__ import annotations

from collections import deque
from itertools import product
from typing import TYPE_CHECKING, Any

from course_lib.offline_ros.modules import _rospy_topics, get_runtime
from course_lib.offline_ros.times import Time

if TYPE_CHECKING:
    from collections.abc import Callable


class SimpleFilter:
    """Passes messages on to callbacks."""

    def __init__(self) -> None:
        self.callbacks: list[tuple[Callable[..., None], tuple[Any, ...]]] = []

    def registerCallback(self, cb: Callable[..., None], *args: object) -> None:  # noqa: N802
        """Add a callback; `args` follow the messages."""
        self.callbacks.append((cb, args))

    def signalMessage(self, *messages: object) -> None:  # noqa: N802
        """Pass messages on."""
        for callback, args in self.callbacks:
            callback(*messages, *args)


class Subscriber(SimpleFilter):
    """A `rospy.Subscriber` as the beginning of a chain of filters."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:  # noqa: ANN401  (rospy.Subscriber's)
        super().__init__()
        self.topic = args[0] if args else kwargs["name"]
        self.sub = _rospy_topics.Subscriber(*args, **{**kwargs, "callback": self.signalMessage})


class Cache(SimpleFilter):
    """Keeps the last messages, and passes them on.

    Parameters
    ----------
    f : SimpleFilter
        Where they come from.
    cache_size : int, optional
        How many are kept.
    allow_headerless : bool, optional
        Messages without header are stamped when they arrive.
    """

    def __init__(
        self,
        f: SimpleFilter,
        cache_size: int = 1,
        allow_headerless: bool = False,  # noqa: FBT001, FBT002  (message_filters')
    ) -> None:
        super().__init__()
        self._headerless = allow_headerless
        self._kept: deque[tuple[Time, Any]] = deque(maxlen=cache_size)
        f.registerCallback(self.add)

    def add(self, msg: Any) -> None:  # noqa: ANN401  (any message class)
        """Keep a message and pass it on."""
        if hasattr(msg, "header"):
            self._kept.append((msg.header.stamp, msg))
        elif self._headerless:
            self._kept.append((Time.now(), msg))
        else:
            return
        self.signalMessage(msg)

    def getInterval(self, from_stamp: Time, to_stamp: Time) -> list[Any]:  # noqa: N802
        """Give what was stamped between two times, in the order in which it came."""
        return [message for stamp, message in self._kept if from_stamp <= stamp <= to_stamp]

    def getElemAfterTime(self, stamp: Time) -> Any:  # noqa: ANN401, N802
        """Give the first that was stamped then or later; None for none."""
        return next((message for kept, message in self._kept if kept >= stamp), None)

    def getElemBeforeTime(self, stamp: Time) -> Any:  # noqa: ANN401, N802
        """Give the last that was stamped then or earlier; None for none."""
        return next((message for kept, message in reversed(self._kept) if kept <= stamp), None)

    def getLast(self) -> Any:  # noqa: ANN401, N802
        """Give the last; None for none."""
        return self._kept[-1][1] if self._kept else None

    def getLatestTime(self) -> Time | None:  # noqa: N802
        """Give the last's time; None for none."""
        return self._kept[-1][0] if self._kept else None

    getLastestTime = getLatestTime  # noqa: N815  (message_filters has this name, too)

    def getOldestTime(self) -> Time | None:  # noqa: N802
        """Give the time of the oldest that is kept; None for none."""
        return self._kept[0][0] if self._kept else None


class ApproximateTimeSynchronizer(SimpleFilter):
    """Brings together messages whose stamps differ by at most `slop` seconds.

    Parameters
    ----------
    fs : list of Subscriber
        The topics.
    queue_size : int
        How many messages of each topic wait for partners.
    slop : float
        Greatest difference of stamps, in seconds.
    allow_headerless : bool, optional
        Messages without header are stamped when they arrive.
    """

    def __init__(
        self,
        fs: list[SimpleFilter],
        queue_size: int,
        slop: float,
        allow_headerless: bool = False,  # noqa: FBT001, FBT002  (message_filters')
    ) -> None:
        super().__init__()
        self._slop_ns = round(slop * 1e9)
        self._size = queue_size
        self._headerless = allow_headerless
        self._queues: list[dict[int, Any]] = [{} for _ in fs]
        for index, source in enumerate(fs):
            source.registerCallback(self._add, index)

    def _add(self, message: Any, index: int) -> None:  # noqa: ANN401  (any message class)
        if hasattr(message, "header"):
            stamp = message.header.stamp.to_nsec()
        elif self._headerless:
            stamp = get_runtime().now_ns()
        else:
            return
        queue = self._queues[index]
        queue[stamp] = message
        if len(queue) > self._size:
            del queue[min(queue)]
        near = [
            [stamp] if i == index else [t for t in q if abs(t - stamp) <= self._slop_ns]
            for i, q in enumerate(self._queues)
        ]
        fitting = [row for row in product(*near) if max(row) - min(row) <= self._slop_ns]
        if not fitting:
            return
        best = min(fitting, key=lambda row: (max(row) - min(row), row))
        messages = [q.pop(t) for q, t in zip(self._queues, best, strict=True)]
        self.signalMessage(*messages)


class TimeSynchronizer(ApproximateTimeSynchronizer):
    """Brings together messages with equal stamps (see `ApproximateTimeSynchronizer`)."""

    def __init__(self, fs: list[SimpleFilter], queue_size: int) -> None:
        super().__init__(fs, queue_size, slop=0.0)
