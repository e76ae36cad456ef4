"""The machine under the node: simulated time, and who is called when.

Time stands still while the node computes and moves only when the node waits (`rospy.spin`,
`Rate.sleep`, `rospy.sleep`, …), to the next message, timer or wake-up. So a run depends on
the recording alone, not on the machine's speed, and lasts no longer than the node computes.
With `rate` the recording plays against the wall clock instead, and a slow node misses
messages, as it does on a robot.
"""

from __future__ import annotations

import itertools
import threading
import time
import traceback
from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from course_lib.offline_ros.agenda import Agenda
from course_lib.offline_ros.errors import BagError
from course_lib.offline_ros.exceptions import ROSInterruptException
from course_lib.offline_ros.messages import type_name
from course_lib.offline_ros.times import Time

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_lib.offline_ros.console import Console
    from course_lib.offline_ros.names import Names
    from course_lib.offline_ros.recorder import Recorder
    from course_lib.offline_ros.source import Source

_SLEEP = threading.Event()  # never set: time.sleep itself is replaced while a node runs
_PATIENCE = 0.5  # wall seconds


@dataclass(eq=False)
class Subscription:
    """One callback on one topic, with the queue in front of it."""

    topic: str
    callback: Callable[[Any], None]
    queue_size: int | None = None
    queue: deque[tuple[int, Callable[[], Any]]] = field(default_factory=deque)
    busy: bool = False


class Runtime:
    """State of the one node that runs in this process.

    Parameters
    ----------
    source : Source
        What is played.
    names : Names
        The node's names and remaps.
    console : Console
        Where log lines go.
    recorder : Recorder, optional
        Keeps what is published.
    rate : float, optional
        Pictures per second of wall clock. Default: as quick as the node allows.
    duration : float, optional
        Simulated seconds after which the node is shut down, counted from the start of the
        recording. Default: one second after its last message.
    keep_going : bool, optional
        Log an exception in a callback and go on, as `rospy` does. Default: stop the node.
    """

    def __init__(
        self,
        source: Source,
        *,
        names: Names,
        console: Console,
        recorder: Recorder | None = None,
        rate: float | None = None,
        duration: float | None = None,
        keep_going: bool = False,
    ) -> None:
        self.source = source
        self.names = names
        self.console = console
        self.recorder = recorder
        self.keep_going = keep_going
        self.initialized = False
        self.reason = ""  # why the node was shut down; empty while it runs
        self.hooks: list[Callable[[], None]] = []
        self.parameters: dict[str, Any] = {"/use_sim_time": True}
        self.subscriptions: list[Subscription] = []
        self.latched: dict[str, tuple[str, bytes]] = {}
        self.published: dict[str, int] = {}
        self.heard: set[str] = set()  # topics that brought something
        self.wanted: set[str] = set()  # topics that were subscribed to
        self.frames = 0
        self.dropped = 0
        self.moves = 0  # counts every step of the clock and every call-back: a sign of life

        self._now = source.start_ns
        self._agenda = Agenda(source, duration)
        self._count = itertools.count()
        self._pump: int | None = None  # the thread that moves the clock
        self._deputy: threading.Thread | None = None  # moves it while the main thread does not
        self._asleep: set[threading.Thread] = set()
        self._depth = 0  # callbacks running inside each other
        self._polled = -1
        self._speed = rate / source.rate if rate and source.rate else None
        self._wall_start = 0.0

    # Time

    def start(self) -> None:
        """Start the clock; called by `init_node`."""
        self.initialized = True
        self._wall_start = time.monotonic()
        Time.clock_ns = self.now_ns

    def now_ns(self) -> int:
        """Give the current time in nanoseconds."""
        if self._speed is not None and not self.reason:
            played = (time.monotonic() - self._wall_start) * self._speed
            self._now = max(self._now, self.source.start_ns + int(played * 1e9))
        return self._now

    def _advance(self, stamp_ns: int) -> None:
        if self._speed is not None:
            while not self.reason and (ahead := stamp_ns - self.now_ns()) > 0:
                _SLEEP.wait(min(ahead / 1e9 / self._speed, 0.1))
                self.moves += 1
        self._now = max(self._now, stamp_ns)
        self.moves += 1

    def at(self, stamp_ns: int, action: Callable[[], None]) -> None:
        """Do something once the clock shows `stamp_ns`."""
        self._agenda.add(stamp_ns, action)

    # Waiting, which is what makes time pass

    def run_until(
        self, deadline_ns: int | None = None, done: Callable[[], bool] = lambda: False
    ) -> None:
        """Let time pass until a moment, a condition or the node's shutdown.

        Parameters
        ----------
        deadline_ns : int, optional
            When to stop waiting. Default: never.
        done : callable, optional
            Stop as soon as it gives true.
        """
        me = threading.get_ident()
        thread = threading.current_thread()
        if thread is threading.main_thread():
            self._deputy = None
        free = self._pump is None and thread in {threading.main_thread(), self._deputy}
        if free or self._pump == me:
            self._move_clock(deadline_ns, done)
        else:
            self._sleep_until(deadline_ns, done)

    def _move_clock(self, deadline_ns: int | None, done: Callable[[], bool]) -> None:
        outer, self._pump = self._pump, threading.get_ident()
        try:
            while not self.reason and not done() and self._step(deadline_ns):
                pass
        finally:
            self._pump = outer

    def poll(self) -> None:
        """Keep a busy loop alive: `while not rospy.is_shutdown()` with nothing that waits.

        Each second call in a row without any waiting in between moves on by one event.
        """
        me = threading.get_ident()
        if self._depth or not self.initialized or self._pump not in {None, me}:
            return
        if me != threading.main_thread().ident:
            return
        if self._polled == self.moves:
            self._pump = me
            try:
                self._step(None, block=False)
            finally:
                self._pump = None
        self._polled = self.moves

    @property
    def in_callback(self) -> bool:
        """Whether the node is inside a callback."""
        return self._depth > 0

    def _step(self, deadline_ns: int | None, *, block: bool = True) -> bool:
        """Do the next thing; false when the deadline or the end is reached."""
        if self._speed is not None:
            self.now_ns()
            self._arrive()  # what came while the node was busy may push older messages out
        # Of what happens at the same moment messages come first, then timers and wake-ups.
        if self._deliver() or self._agenda.fire(self._now):
            return True
        due = self._agenda.next_ns()
        end_ns = self._agenda.end_ns()
        stop_ns = min((t for t in (deadline_ns, end_ns) if t is not None), default=None)
        if due is not None and (stop_ns is None or due <= stop_ns):
            if not block and self._speed is not None and due > self.now_ns():
                _SLEEP.wait(0.001)
                return True
            self._advance(due)
            self._arrive()
            return True
        if stop_ns is None:  # cannot be: with no message left there is an end
            return False
        self._advance(stop_ns)
        if stop_ns == end_ns:
            self.shutdown("the recording has ended")
        return False

    def _arrive(self) -> None:
        """Put the messages that are due into the queues."""
        for arrival in self._agenda.arrivals(self._now):
            self.frames += arrival.topic == self.source.camera
            self.enqueue(arrival.topic, arrival.load)

    def ticket(self) -> int:
        """Give the next number in the order of arrival."""
        return next(self._count)

    def enqueue(self, topic: str, load: Callable[[], Any]) -> None:
        """Put a message in the queues of a topic's subscribers; a full queue loses its oldest."""
        for subscription in self.subscriptions:
            if subscription.topic == topic:
                self.heard.add(topic)
                subscription.queue.append((self.ticket(), load))
                size = subscription.queue_size
                if size and len(subscription.queue) > size:
                    subscription.queue.popleft()
                    self.dropped += 1

    def _deliver(self) -> bool:
        """Call one callback with the oldest waiting message."""
        # A callback that waits is not called again meanwhile: ROS serves a topic in one thread.
        waiting = [s for s in self.subscriptions if s.queue and not s.busy]
        if not waiting:
            return False
        subscription = min(waiting, key=lambda s: s.queue[0][0])
        _, load = subscription.queue.popleft()
        subscription.busy = True
        try:
            message = load()
            message._connection_header = {  # noqa: SLF001  (rospy's name)
                "callerid": "/offline_ros",
                "topic": subscription.topic,
                "type": type_name(message),
            }
            self.call(subscription.callback, message)
        finally:
            subscription.busy = False
        return True

    def call(self, callback: Callable[..., None], *args: object) -> None:
        """Call into the node from outside its own flow: a callback or a timer."""
        self.moves += 1
        self._depth += 1
        try:
            callback(*args)
        except ROSInterruptException:
            if not self.reason:
                raise
        except BagError:
            raise
        except Exception:
            if not self.keep_going:
                raise
            self.console.log("ERROR", f"bad callback: {callback}\n{traceback.format_exc()}")
        finally:
            self._depth -= 1

    # Threads of the node: one moves the clock, the others sleep until it wakes them.

    def _sleep_until(self, deadline_ns: int | None, done: Callable[[], bool]) -> None:
        me = threading.current_thread()
        woken = threading.Event()
        if deadline_ns is not None:
            self.at(deadline_ns, lambda: self._hand_over(me, woken))
        self._asleep.add(me)
        patience = time.monotonic() + _PATIENCE
        while not self.reason and not done() and not woken.wait(0.005):
            if self._pump is not None:
                patience = time.monotonic() + _PATIENCE
            elif me is threading.main_thread() or time.monotonic() > patience:
                # Nobody moves the clock, as when the main thread waits in Thread.join().
                self._asleep.discard(me)
                self._deputy = me
                self._move_clock(deadline_ns, done)
                return
        self._asleep.discard(me)

    def _hand_over(self, thread: threading.Thread, woken: threading.Event) -> None:
        """Wake a thread and let it work until it waits again, so that runs repeat exactly."""
        if thread is threading.current_thread() or thread not in self._asleep:
            return
        self._asleep.discard(thread)
        woken.set()
        end = time.monotonic() + 2 * _PATIENCE
        while thread.is_alive() and thread not in self._asleep and time.monotonic() < end:
            _SLEEP.wait(0.001)

    # The end

    def shutdown(self, reason: str) -> None:
        """Shut the node down: hooks run, everything that waits returns."""
        if self.reason:
            return
        self.reason = reason or "shutdown"
        for hook in self.hooks:
            try:
                hook()
            except Exception:  # noqa: BLE001  (one bad hook must not stop the others)
                self.console.log("ERROR", f"bad shutdown hook: {traceback.format_exc()}")
