"""Topics in `rospy`: `Subscriber`, `Publisher`, `wait_for_message`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_lib.offline_ros.exceptions import (
    ROSException,
    ROSInitException,
    ROSInterruptException,
    ROSSerializationException,
)
from course_lib.offline_ros.messages import Message, type_name
from course_lib.offline_ros.modules import get_runtime
from course_lib.offline_ros.runtime import Subscription
from course_lib.offline_ros.times import Duration
from course_lib.offline_ros.wire import deserialize, serialize

if TYPE_CHECKING:
    from collections.abc import Callable


class Subscriber:
    """Calls back with each message of a topic.

    Parameters
    ----------
    name : str
        The topic.
    data_class : type
        The message class.
    callback : callable, optional
        Takes the message, and `callback_args` if given.
    callback_args : object, optional
        A second argument for the callback.
    queue_size : int, optional
        How many messages wait while the callback is busy; the oldest is dropped. Default: all.
    buff_size, tcp_nodelay : optional
        Accepted as in `rospy`; nothing is sent over a network here.

    Raises
    ------
    ValueError
        When `data_class` is no message class.
    """

    def __init__(
        self,
        name: str,
        data_class: type[Message],
        callback: Callable[..., None] | None = None,
        callback_args: object = None,
        queue_size: int | None = None,
        buff_size: int = 65536,
        tcp_nodelay: bool = False,  # noqa: FBT001, FBT002  (rospy's)
    ) -> None:
        _ = buff_size, tcp_nodelay
        _check_class(data_class)
        runtime = get_runtime()
        self.name = self.resolved_name = runtime.names.topic(name)
        self.data_class: Any = data_class
        self.type = type_name(data_class)
        self._mine: list[Subscription] = []
        self._queue_size = queue_size
        runtime.wanted.add(self.name)
        self.impl: Any = self
        played = runtime.source.topics.get(self.name)
        if played and played != self.type:
            runtime.console.log(
                "ERROR",
                f"{self.name} carries {played}, but the node subscribes to it as {self.type}: "
                "it will receive nothing",
            )
            return
        if callback is not None:
            self.add_callback(callback, callback_args)

    def add_callback(self, cb: Callable[..., None], cb_args: object = None) -> None:
        """Add a callback."""
        runtime = get_runtime()
        prepare = getattr(self.data_class, "with_arrays", None)

        def call(message: Message) -> None:
            if prepare:  # a class of rospy.numpy_msg
                message = prepare(message)
            cb(message) if cb_args is None else cb(message, cb_args)

        subscription = Subscription(self.name, call, self._queue_size)
        self._mine.append(subscription)
        runtime.subscriptions.append(subscription)
        if self.name in runtime.latched:
            runtime.heard.add(self.name)
            kind, raw = runtime.latched[self.name]
            subscription.queue.append((runtime.ticket(), lambda: deserialize(raw, kind)))

    def get_num_connections(self) -> int:
        """Give 1 when the recording or the node itself publishes this topic, else 0."""
        runtime = get_runtime()
        return int(self.name in runtime.source.topics or self.name in runtime.published)

    def unregister(self) -> None:
        """Stop listening."""
        runtime = get_runtime()
        mine, self._mine = self._mine, []
        runtime.subscriptions = [s for s in runtime.subscriptions if s not in mine]


class Publisher:
    """Publishes messages on a topic.

    Parameters
    ----------
    name : str
        The topic.
    data_class : type
        The message class.
    latch : bool, optional
        Later subscribers get the last message at once.
    queue_size : int, optional
        Accepted as in `rospy`; what is published is never lost here.
    subscriber_listener, tcp_nodelay, headers : optional
        Accepted as in `rospy`.

    Raises
    ------
    ValueError
        When `data_class` is no message class.
    """

    def __init__(
        self,
        name: str,
        data_class: type[Message],
        subscriber_listener: object = None,
        tcp_nodelay: bool = False,  # noqa: FBT001, FBT002  (rospy's)
        latch: bool = False,  # noqa: FBT001, FBT002
        headers: object = None,
        queue_size: int | None = None,
    ) -> None:
        _ = subscriber_listener, tcp_nodelay, headers, queue_size
        _check_class(data_class)
        runtime = get_runtime()
        self.name = self.resolved_name = runtime.names.topic(name)
        self.data_class: Any = data_class
        self.type = type_name(data_class)
        self._latch = latch
        self._open = True
        self.impl: Any = self
        runtime.published.setdefault(self.name, 0)
        if runtime.recorder:
            runtime.recorder.announce(self.name, self.type, latch=latch)

    def publish(self, *args: object, **kwds: object) -> None:
        """Publish a message, or the fields of one.

        Raises
        ------
        ROSException
            When `init_node` was not called or the publisher is closed.
        ROSSerializationException
            When a field holds a value of the wrong type.
        """
        runtime = get_runtime()
        if not runtime.initialized:
            msg = "ROS node has not been initialized yet. Please call init_node() first"
            raise ROSException(msg)
        if not self._open:
            msg = "publish() to a closed topic"
            raise ROSException(msg)
        message = self._message(args, kwds)
        if message._has_header:  # noqa: SLF001
            message.header.seq = runtime.published[self.name] + 1
        raw = serialize(message)
        runtime.published[self.name] += 1
        if self._latch:
            runtime.latched[self.name] = (self.type, raw)
        if runtime.recorder:
            runtime.recorder.write(self.name, runtime.now_ns(), self.type, raw)
        runtime.source.hear(self.name, self.type, runtime.now_ns(), raw)
        runtime.enqueue(self.name, lambda: deserialize(raw, self.type))

    def _message(self, args: tuple[object, ...], kwds: dict[str, object]) -> Any:  # noqa: ANN401
        if len(args) == 1 and not kwds and isinstance(args[0], Message):
            if isinstance(args[0], self.data_class):
                return args[0]
            # A message may still be the only field of the one to publish.
            if len(self.data_class.__slots__) != 1 or self.type == type_name(args[0]):
                msg = f"{self.name}: expected [{self.type}] but got [{type_name(args[0])}]"
                raise ROSSerializationException(msg)
        try:
            return self.data_class(*args, **kwds)
        except (TypeError, AttributeError) as error:
            msg = f"{self.name}: {error}"
            raise ROSSerializationException(msg) from error

    def get_num_connections(self) -> int:
        """Give how many listen: the node's own subscribers, and the recording."""
        runtime = get_runtime()
        own = sum(s.topic == self.name for s in runtime.subscriptions)
        return own + (runtime.recorder is not None)

    def unregister(self) -> None:
        """Close the publisher."""
        self._open = False


def _check_class(data_class: object) -> None:
    if not (isinstance(data_class, type) and issubclass(data_class, Message)):
        msg = f"data_class [{data_class}] is not a message data class"
        raise ValueError(msg)  # noqa: TRY004  (as rospy)


def wait_for_message(
    topic: str, topic_type: type[Message], timeout: Duration | float | None = None
) -> Any:  # noqa: ANN401  (any message class)
    """Wait for one message.

    Parameters
    ----------
    topic : str
        The topic.
    topic_type : type
        The message class.
    timeout : Duration or float, optional
        Simulated seconds to wait. Default: until it comes.

    Returns
    -------
    Message
        The message.

    Raises
    ------
    ROSException
        When it did not come in time.
    ROSInterruptException
        When the node is shut down before.
    """
    runtime = get_runtime()
    if not runtime.initialized:
        msg = "client code must call rospy.init_node() first"
        raise ROSInitException(msg)
    received: list[Any] = []
    subscriber = Subscriber(topic, topic_type, received.append, queue_size=1)
    deadline = None
    if timeout is not None:
        seconds = timeout.to_sec() if isinstance(timeout, Duration) else timeout
        deadline = runtime.now_ns() + int(seconds * 1e9)
    try:
        runtime.run_until(deadline, lambda: bool(received))
    finally:
        subscriber.unregister()
    if received:
        return received[0]
    if runtime.reason:
        msg = "rospy shutdown"
        raise ROSInterruptException(msg)
    msg = f"timeout exceeded while waiting for message on topic {subscriber.name}"
    raise ROSException(msg)
