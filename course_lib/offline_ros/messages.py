"""ROS 1 message classes, made from the definitions that `rosbags` carries.

A message behaves as the ones `genpy` generates: every field has a default, keyword or all
positional arguments fill it, any value may be assigned, and types are checked when it is
published. Wire format, definitions and MD5 sums come from `rosbags`.
"""

from __future__ import annotations

from functools import cache
from typing import Any, ClassVar

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from course_lib.offline_ros.times import Duration, Time

STORE = get_typestore(Stores.ROS1_NOETIC)

_TIME = "builtin_interfaces/msg/Time"
_DURATION = "builtin_interfaces/msg/Duration"
BYTE_TYPES = frozenset({"uint8", "char"})


class Message:
    """Base of all message classes.

    Attributes
    ----------
    _type : str
        ROS 1 type name, such as `sensor_msgs/Image`.
    _md5sum : str
        MD5 sum of the definition, as ROS computes it.
    _full_text : str
        The definition.
    _slot_types : list of str
        Type of each field, as in `__slots__`.
    _connection_header : dict of str to str
        Of a message that a callback gets: its `topic`, `type` and `callerid`.
    """

    __slots__: tuple[str, ...] = ("_connection_header",)
    _type: ClassVar[str] = ""
    _md5sum: ClassVar[str] = ""
    _full_text: ClassVar[str] = ""
    _slot_types: ClassVar[list[str]] = []
    _fields: ClassVar[list[tuple[str, Any]]] = []
    _has_header: ClassVar[bool] = False

    def __init__(self, *args: object, **kwargs: object) -> None:
        if args and kwargs:
            msg = f"{self._type}: give positional or keyword arguments, not both"
            raise TypeError(msg)
        if args:
            if len(args) != len(self.__slots__):
                msg = (
                    f"{self._type} takes {len(self.__slots__)} positional arguments "
                    f"({', '.join(self.__slots__)}), got {len(args)}"
                )
                raise TypeError(msg)
            kwargs = dict(zip(self.__slots__, args, strict=True))
        if unknown := kwargs.keys() - set(self.__slots__):
            msg = f"{self._type} has no field {', '.join(sorted(unknown))}"
            raise AttributeError(msg)
        for name, desc in self._fields:
            value = kwargs.get(name)
            setattr(self, name, _default(desc) if value is None else value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and all(
            np.array_equal(mine, yours) if isinstance(mine, np.ndarray) else mine == yours
            for mine, yours in (
                (getattr(self, name), getattr(other, name)) for name in self.__slots__
            )
        )

    __hash__ = None  # type: ignore[assignment]  # a message is mutable

    def __repr__(self) -> str:
        return _text(self, "")

    __str__ = __repr__


def _text(value: object, indent: str) -> str:
    """Write a value as `rostopic echo` does."""
    if isinstance(value, Message):
        lines = []
        for name in value.__slots__:
            item = getattr(value, name)
            if isinstance(item, (Message, Time, Duration)):
                lines.append(f"{indent}{name}: \n{_text(item, indent + '  ')}")
            elif isinstance(item, list) and item and isinstance(item[0], Message):
                rows = (f"{indent}  - \n{_text(row, indent + '    ')}" for row in item)
                lines.append(f"{indent}{name}: \n" + "\n".join(rows))
            else:
                lines.append(f"{indent}{name}: {_text(item, indent)}")
        return "\n".join(lines)
    if isinstance(value, (Time, Duration)):
        return f"{indent}secs: {value.secs}\n{indent}nsecs: {value.nsecs:>9}"
    if isinstance(value, bytes):
        shown = ", ".join(map(str, value[:32]))
        return f"[{shown}{', ...' if len(value) > 32 else ''}]"
    if isinstance(value, str):
        return f'"{value}"' if value else "''"
    return str(value)


def _default(desc: Any) -> Any:  # noqa: ANN401  (rosbags' descriptors are nested tuples)
    kind, detail = desc
    if kind == Nodetype.BASE:
        return {"string": "", "bool": False, "float32": 0.0, "float64": 0.0}.get(detail[0], 0)
    if kind == Nodetype.NAME:
        return message_class(detail)()
    inner, length = detail
    if inner[0] == Nodetype.BASE and inner[1][0] in BYTE_TYPES:
        return b"\0" * length
    return [_default(inner) for _ in range(length if kind == Nodetype.ARRAY else 0)]


def message_class(msgtype: str) -> Any:  # noqa: ANN401  (a class made here, or Time, Duration)
    """Give the class of a message type.

    Parameters
    ----------
    msgtype : str
        `sensor_msgs/Image` or, as `rosbags` writes it, `sensor_msgs/msg/Image`.

    Returns
    -------
    type
        A subclass of `Message`; `Time` or `Duration` for ROS 1's two built-in types.

    Raises
    ------
    KeyError
        When no such message type is known.
    """
    return _make_class(full_name(msgtype))


def full_name(msgtype: str) -> str:
    """Write a type as `rosbags` does.

    Parameters
    ----------
    msgtype : str
        `sensor_msgs/Image` or `sensor_msgs/msg/Image`.

    Returns
    -------
    str
        `sensor_msgs/msg/Image`.
    """
    package, _, name = msgtype.replace("/msg/", "/").partition("/")
    return f"{package}/msg/{name}"


@cache
def _make_class(full: str) -> Any:  # noqa: ANN401
    package, _, name = full.partition("/msg/")
    if full in {_TIME, _DURATION}:
        return Time if full == _TIME else Duration
    if full not in STORE.fielddefs:
        msg = f"no message type {package}/{name}"
        raise KeyError(msg)
    constants, fields = STORE.fielddefs[full]
    fields = [pair for pair in fields if pair[0] != "structure_needs_at_least_one_member"]
    text, md5sum = STORE.generate_msgdef(full)
    body: dict[str, Any] = {
        "__slots__": tuple(field for field, _ in fields),
        "__doc__": f"ROS message {package}/{name}.",
        "__module__": f"{package}.msg",
        "_type": f"{package}/{name}",
        "_md5sum": md5sum,
        "_full_text": text,
        "_fields": fields,
        "_slot_types": [_type_name(desc) for _, desc in fields],
        "_has_header": any(desc == (Nodetype.NAME, "std_msgs/msg/Header") for _, desc in fields),
    }
    body.update({constant: value for constant, _, value in constants})
    return type(name, (Message,), body)


def _type_name(desc: Any) -> str:  # noqa: ANN401
    kind, detail = desc
    if kind == Nodetype.BASE:
        return str(detail[0])
    if kind == Nodetype.NAME:
        short = {_TIME: "time", _DURATION: "duration"}
        return short.get(detail, str(detail).replace("/msg/", "/"))
    inner, length = detail
    return f"{_type_name(inner)}[{length if kind == Nodetype.ARRAY else ''}]"


def type_name(message: Message | type[Message]) -> str:
    """Give the ROS 1 type of a message or message class, such as `sensor_msgs/Image`."""
    return message._type  # noqa: SLF001  (genpy's own attribute name)
