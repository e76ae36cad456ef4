"""The node and its topics: `init_node`, `Subscriber`, `Publisher`, `spin` and the like."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_lib.offline_ros.console import LEVELS
from course_lib.offline_ros.exceptions import (
    ROSException,
    ROSInitException,
    ROSInterruptException,
    ROSSerializationException,
)
from course_lib.offline_ros.messages import Message, deserialize, serialize, type_name
from course_lib.offline_ros.modules import get_runtime
from course_lib.offline_ros.names import split_arguments
from course_lib.offline_ros.runtime import Subscription
from course_lib.offline_ros.times import Duration

if TYPE_CHECKING:
    from collections.abc import Callable


def init_node(
    name: str,
    argv: list[str] | None = None,
    anonymous: bool = False,  # noqa: FBT001, FBT002  (rospy's)
    log_level: int | None = None,
    **_options: object,
) -> None:
    """Name the node and start the clock.

    Parameters
    ----------
    name : str
        The node's name, without slashes; `__name:=` on the command line wins.
    argv : list of str, optional
        Further `name:=value` arguments.
    anonymous : bool, optional
        Make the name unique by a number.
    log_level : int, optional
        `rospy.DEBUG` to `rospy.FATAL`.

    Raises
    ------
    ValueError
        When the name is empty or holds a slash.
    ROSException
        When the node already has another name.
    """
    runtime = get_runtime()
    if not name:
        msg = "name must not be empty"
        raise ValueError(msg)
    if "/" in name:
        msg = f"namespaces are not allowed in node names: {name}"
        raise ValueError(msg)
    if argv:
        runtime.names.mappings.update(split_arguments(argv)[1])
    before = runtime.names.node
    # ROS adds process id and time; a fixed number keeps runs equal.
    runtime.names.set_node(f"{name}_1" if anonymous else name)
    if runtime.initialized:
        if runtime.names.node != before:
            after, runtime.names.node = runtime.names.node, before
            msg = f"rospy.init_node() has already been called as {before}, now as {after}"
            raise ROSException(msg)
        return
    runtime.console.node = runtime.names.node
    if log_level is not None:
        runtime.console.threshold = log_level
    for full, value in runtime.names.private_parameters().items():
        runtime.parameters.setdefault(full, value)
    runtime.start()


def get_name() -> str:
    """Give the node's full name."""
    return get_runtime().names.node


def get_caller_id() -> str:
    """Give the node's full name."""
    return get_name()


def get_namespace() -> str:
    """Give the namespace the node lives in."""
    return get_runtime().names.namespace


def get_node_uri() -> str | None:
    """Give None: the node has no address here."""
    return None


def resolve_name(name: str, caller_id: str | None = None) -> str:
    """Give the global, remapped form of a name."""
    _ = caller_id
    return get_runtime().names.resolve(name)


def remap_name(name: str, caller_id: str | None = None) -> str:
    """Give the global, remapped form of a name."""
    return resolve_name(name, caller_id)


def get_published_topics(namespace: str = "/") -> list[list[str]]:
    """Give [topic, type] of what the recording plays and the node publishes."""
    topics = get_runtime().source.topics
    return [[topic, kind] for topic, kind in sorted(topics.items()) if topic.startswith(namespace)]


def myargv(argv: list[str] | None = None) -> list[str]:
    """Give the command line without `name:=value` arguments."""
    import sys  # noqa: PLC0415

    return split_arguments(sys.argv if argv is None else argv)[0]


def is_shutdown() -> bool:
    """Tell whether the node is being shut down.

    A loop that only asks this, without waiting for anything, moves time on too.
    """
    runtime = get_runtime()
    runtime.poll()
    return bool(runtime.reason)


def is_initialized() -> bool:
    """Tell whether `init_node` was called."""
    return get_runtime().initialized


def on_shutdown(h: Callable[[], None]) -> None:
    """Register a function that is called when the node is shut down."""
    if not callable(h):
        msg = f"shutdown hook [{h}] must be a function"
        raise TypeError(msg)
    get_runtime().hooks.append(h)


def signal_shutdown(reason: str) -> None:
    """Shut the node down."""
    get_runtime().shutdown(str(reason))


def spin() -> None:
    """Deliver messages until the node is shut down.

    Raises
    ------
    ROSInitException
        When `init_node` was not called.
    """
    runtime = get_runtime()
    if not runtime.initialized:
        msg = "client code must call rospy.init_node() first"
        raise ROSInitException(msg)
    try:
        while not runtime.reason:
            runtime.run_until()
    except KeyboardInterrupt:
        runtime.shutdown("keyboard interrupt")


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
        self.name = self.resolved_name = runtime.names.resolve(name)
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
        call = cb if cb_args is None else lambda message: cb(message, cb_args)
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
        self.name = self.resolved_name = runtime.names.resolve(name)
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


DEBUG, INFO, WARN, ERROR, FATAL = LEVELS.values()
