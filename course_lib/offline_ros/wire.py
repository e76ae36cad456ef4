"""Messages as bytes: ROS 1's wire format, with every field checked on the way out."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype

from course_lib.offline_ros.exceptions import ROSSerializationException
from course_lib.offline_ros.messages import (
    BYTE_TYPES,
    STORE,
    Message,
    full_name,
    message_class,
    type_name,
)
from course_lib.offline_ros.times import Duration, Time

_DTYPES = {"bool": "bool", "char": "uint8", "byte": "int8"}


def serialize(message: Message) -> bytes:
    """Write a message in ROS 1's wire format.

    Parameters
    ----------
    message : Message
        Any message made by `message_class`.

    Returns
    -------
    bytes
        The serialized message.

    Raises
    ------
    ROSSerializationException
        When a field holds a value of the wrong type; the message names it.
    """
    full = full_name(type_name(message))
    native = _to_native((Nodetype.NAME, full), message, type_name(message))
    return bytes(STORE.serialize_ros1(native, full))


def deserialize(raw: bytes | memoryview, msgtype: str) -> Any:  # noqa: ANN401  (any message class)
    """Read a message from ROS 1's wire format.

    Parameters
    ----------
    raw : bytes
        The serialized message.
    msgtype : str
        Its type, as for `message_class`.

    Returns
    -------
    Message
        An instance of that type's class.
    """
    full = full_name(msgtype)
    return from_native(STORE.deserialize_ros1(raw, full), full)


def from_native(native: object, msgtype: str) -> Any:  # noqa: ANN401  (any message class)
    """Turn a message object of `rosbags`, ROS 1 or ROS 2, into one of ours.

    Parameters
    ----------
    native : object
        What `rosbags` deserialized.
    msgtype : str
        Its type, as for `message_class`.

    Returns
    -------
    Message
        An instance of that type's class; fields that ROS 2 dropped keep their default.
    """
    return _from_native((Nodetype.NAME, msgtype), native)


def _from_native(desc: Any, value: Any) -> Any:  # noqa: ANN401
    kind, detail = desc
    if kind == Nodetype.BASE:
        return value
    if kind == Nodetype.NAME:
        cls = message_class(detail)
        if cls in (Time, Duration):
            return cls(int(value.sec), int(value.nanosec))
        values = {}
        for name, field in cls._fields:
            # ROS 2 writes CameraInfo's D, K, R, P in lower case and has no header.seq.
            item = getattr(value, name, getattr(value, name.lower(), None))
            values[name] = None if item is None else _from_native(field, item)
        return cls(**values)
    inner = detail[0]
    if inner[0] != Nodetype.BASE:
        return [_from_native(inner, item) for item in value]
    if inner[1][0] in BYTE_TYPES:
        return bytes(value)
    return list(value) if inner[1][0] == "string" else tuple(value.tolist())


def _to_native(desc: Any, value: Any, path: str) -> Any:  # noqa: ANN401
    kind, detail = desc
    if kind == Nodetype.BASE:
        return _to_base(detail[0], value, path)
    if kind == Nodetype.NAME:
        cls = message_class(detail)
        if not isinstance(value, cls):
            wanted = getattr(cls, "_type", cls.__name__)
            msg = f"{path} must be a {wanted}, not {type(value).__name__}"
            raise ROSSerializationException(msg)
        native = STORE.types[detail]
        if isinstance(value, (Time, Duration)):
            return native(value.secs, value.nsecs)
        return native(
            *(
                _to_native(field, getattr(value, name), f"{path}.{name}")
                for name, field in cls._fields
            )
        )
    inner, length = detail
    if kind == Nodetype.ARRAY and len(value) != length:
        msg = f"{path} must hold {length} values, not {len(value)}"
        raise ROSSerializationException(msg)
    if inner[0] == Nodetype.NAME or inner[1][0] == "string":
        return [_to_native(inner, item, f"{path}[{i}]") for i, item in enumerate(value)]
    return _to_array(inner[1][0], value, path)


def _to_base(base: str, value: Any, path: str) -> Any:  # noqa: ANN401
    try:
        if base == "string":
            if not isinstance(value, (str, bytes)):
                raise TypeError  # noqa: TRY301
            return value.decode() if isinstance(value, bytes) else value
        if base == "bool":
            return bool(value)
        if base.startswith("float"):
            return float(value)
        number = operator.index(value)
    except (TypeError, ValueError) as error:
        msg = f"{path} must be a {base}, not {type(value).__name__} {value!r:.60}"
        raise ROSSerializationException(msg) from error
    bounds = np.iinfo(_DTYPES.get(base, base))
    if not bounds.min <= number <= bounds.max:
        msg = f"{path} = {number} does not fit in {base} ({bounds.min} to {bounds.max})"
        raise ROSSerializationException(msg)
    return number


def _to_array(base: str, value: Any, path: str) -> Any:  # noqa: ANN401
    dtype = np.dtype(_DTYPES.get(base, base))
    if isinstance(value, (bytes, bytearray, memoryview)):
        return np.frombuffer(value, dtype=dtype)
    try:
        array = np.asarray(value)
        wrong = array.size and not np.can_cast(array.dtype, dtype, casting="same_kind")
        if wrong and not (array.dtype.kind in "iu" and dtype.kind in "iu"):
            raise TypeError  # noqa: TRY301
        return np.ascontiguousarray(np.asarray(value, dtype=dtype)).reshape(-1)
    except (TypeError, ValueError, OverflowError) as error:
        msg = f"{path} must be a list of {base}, not {type(value).__name__} {value!r:.60}"
        raise ROSSerializationException(msg) from error
