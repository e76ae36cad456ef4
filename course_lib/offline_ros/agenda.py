"""What comes next: the recording's messages, and what the node put off to a later moment."""

from __future__ import annotations

import heapq
import itertools
import threading
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from course_lib.offline_ros.bag import Arrival
    from course_lib.offline_ros.source import Source

# After the last message a node gets this long for what it does at a slower rate.
GRACE_NS = 1_000_000_000


class Agenda:
    """Everything that is to happen in simulated time.

    Parameters
    ----------
    source : Source
        The recording.
    duration : float, optional
        Simulated seconds until the end. Default: one second after the last message.
    """

    def __init__(self, source: Source, duration: float | None = None) -> None:
        self._messages = iter(source)
        self._next: Arrival | None = next(self._messages, None)
        self._last_ns = source.start_ns
        self._end_ns = None if duration is None else source.start_ns + int(duration * 1e9)
        self._count = itertools.count()
        self._actions: list[tuple[int, int, Callable[[], None]]] = []
        self._lock = threading.Lock()

    def add(self, stamp_ns: int, action: Callable[[], None]) -> None:
        """Put off an action; threads of the node may call this."""
        with self._lock:
            heapq.heappush(self._actions, (stamp_ns, next(self._count), action))

    def next_ns(self) -> int | None:
        """Give the moment of the next message or action; None when there is none."""
        moments = [self._actions[0][0]] if self._actions else []
        if self._next is not None:
            moments.append(self._next.stamp_ns)
        return min(moments, default=None)

    def end_ns(self) -> int | None:
        """Give the end, once it is known."""
        if self._end_ns is None and self._next is None:
            return self._last_ns + GRACE_NS
        return self._end_ns

    def arrivals(self, now_ns: int) -> Iterator[Arrival]:
        """Take the messages that are due."""
        while self._next is not None and self._next.stamp_ns <= now_ns:
            arrival, self._next = self._next, next(self._messages, None)
            self._last_ns = arrival.stamp_ns
            yield arrival

    def fire(self, now_ns: int) -> bool:
        """Do one action that is due; false when there is none."""
        with self._lock:
            if not self._actions or self._actions[0][0] > now_ns:
                return False
            action = heapq.heappop(self._actions)[2]
        action()
        return True
