"""The node in `rospy`: its name, its life and its end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_lib.offline_ros.console import LEVELS
from course_lib.offline_ros.exceptions import ROSException, ROSInitException
from course_lib.offline_ros.modules import get_runtime
from course_lib.offline_ros.names import split_arguments

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


DEBUG, INFO, WARN, ERROR, FATAL = LEVELS.values()
