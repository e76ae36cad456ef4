"""
Plain data between the grader and a student's process: never code, never a pickle.

A value is turned into a tree that JSON can hold and a list of byte buffers for what is large. Both
sides use `encode`; only the grader's `decode` matters for safety, since it is the one that reads
what a stranger wrote: it believes nothing, and has a limit on everything.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

MOST_BYTES = 64 * 2**20  # of one value's buffers: a 4000 x 4000 colour picture fits
MOST_NODES = 200_000
MOST_DEPTH = 12
MOST_TEXT = 100_000
_MOST_DIMENSIONS = 8
_MOST_KEYS = 2000  # a stranger can choose numbers that all fall into one place of a dict
_DTYPES = frozenset(
    ["bool", "uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64"]
    + ["float16", "float32", "float64"]
)
_KEYPOINT = 7  # x, y, size, angle, response, octave, class_id
_MATCH = 4  # query index, train index, image index, distance

Tree = Any  # what JSON can hold


class BadDataError(ValueError):
    """A value that cannot cross, or that did not arrive in order."""


@dataclass(frozen=True)
class Unknown:
    """Stands for a returned object of a type that does not cross.

    Attributes
    ----------
    type_name : str
        Its type, as its own process called it.
    """

    type_name: str


def encode(value: object) -> tuple[Tree, list[bytes]]:
    """Turn a value into a tree for JSON and buffers.

    Parameters
    ----------
    value : object
        None, truth values, numbers, text, bytes, numeric arrays, keypoints, matches, and lists,
        tuples, dicts of these. Anything else becomes `Unknown`.

    Returns
    -------
    tree : object
        What `json.dumps` takes.
    buffers : list of bytes
        What the tree refers to by number.

    Raises
    ------
    BadDataError
        When it is too large or too deep to cross.
    """
    encoder = _Encoder()
    return encoder.node(value, 0), encoder.buffers


class _Encoder:
    def __init__(self) -> None:
        self.buffers: list[bytes] = []
        self._bytes = 0
        self._nodes = 0

    def node(self, value: object, depth: int) -> Tree:
        self._nodes += 1
        if self._nodes > MOST_NODES:
            raise BadDataError(f"the value has more than {MOST_NODES} parts")
        if depth > MOST_DEPTH:
            raise BadDataError(f"the value is nested more than {MOST_DEPTH} deep")
        if isinstance(value, np.generic):
            value = value.item()
        if value is None or isinstance(value, bool | int | float | str):
            return self._scalar(value)
        if isinstance(value, bytes | bytearray | memoryview):
            return {"t": "bytes", "b": self._buffer(bytes(value))}
        if isinstance(value, np.ndarray):
            return self._array(value)
        if isinstance(value, cv2.KeyPoint | cv2.DMatch):
            return {**self._records([value]), "one": True}
        return self._container(value, depth)

    def _scalar(self, value: bool | float | str | None) -> Tree:  # noqa: FBT001
        if isinstance(value, str):
            if len(value) > MOST_TEXT:
                raise BadDataError(f"the text is longer than {MOST_TEXT} characters")
            return str(value).encode("utf-8", "replace").decode()
        if isinstance(value, float):
            value = float(value)
            return value if math.isfinite(value) else {"t": "float", "v": repr(value)}
        if (
            isinstance(value, int) and type(value) is not bool
        ):  # an enum, too, is sent as its number
            return int(value) if abs(value) < 2**63 else self._unknown(value)
        return value

    def _container(self, value: object, depth: int) -> Tree:
        if isinstance(value, list | tuple):
            kinds = {type(item) for item in value}
            if len(kinds) == 1 and kinds <= {cv2.KeyPoint, cv2.DMatch}:
                return {**self._records(value), "tuple": isinstance(value, tuple)}
            kind = "tuple" if isinstance(value, tuple) else "list"
            return {"t": kind, "v": [self.node(item, depth + 1) for item in value]}
        if isinstance(value, dict):
            if len(value) > _MOST_KEYS:
                raise BadDataError(f"a dict has more than {_MOST_KEYS} keys")
            pairs = [[self.node(k, depth + 1), self.node(v, depth + 1)] for k, v in value.items()]
            return {"t": "dict", "v": pairs}
        return self._unknown(value)

    def _unknown(self, value: object) -> Tree:
        return {"t": "unknown", "v": type(value).__qualname__[:200]}

    def _buffer(self, data: bytes) -> int:
        self._bytes += len(data)
        if self._bytes > MOST_BYTES:
            raise BadDataError(f"the value is larger than {MOST_BYTES // 2**20} MiB")
        self.buffers.append(data)
        return len(self.buffers) - 1

    def _array(self, array: np.ndarray[Any, Any]) -> Tree:
        if array.dtype == object and array.ndim == 1 and 0 < array.size <= MOST_NODES:
            kinds = {type(item) for item in array}
            if len(kinds) == 1 and kinds <= {cv2.KeyPoint, cv2.DMatch}:
                return {**self._records(array.tolist()), "tuple": False}  # a list to be indexed
        if array.dtype.name not in _DTYPES or array.ndim > _MOST_DIMENSIONS:
            return {"t": "unknown", "v": f"array of {array.dtype.name}"[:200]}
        if array.nbytes > MOST_BYTES:  # before tobytes makes a copy of it
            raise BadDataError(f"the array is larger than {MOST_BYTES // 2**20} MiB")
        data = np.asarray(array, dtype=array.dtype.newbyteorder("<")).tobytes()
        shape = [int(n) for n in array.shape]
        return {"t": "array", "d": array.dtype.name, "s": shape, "b": self._buffer(data)}

    def _records(self, items: Sequence[Any]) -> Tree:
        if isinstance(items[0], cv2.KeyPoint):
            rows = [(*k.pt, k.size, k.angle, k.response, k.octave, k.class_id) for k in items]
            return {"t": "keypoints", "b": self._buffer(np.array(rows, "<f8").tobytes())}
        rows = [(m.queryIdx, m.trainIdx, m.imgIdx, m.distance) for m in items]
        return {"t": "matches", "b": self._buffer(np.array(rows, "<f8").tobytes())}


def decode(tree: Tree, buffers: Sequence[bytes | memoryview]) -> Any:  # noqa: ANN401
    """Turn what `encode` made, or what a stranger made up, back into a value.

    Parameters
    ----------
    tree : object
        As it came out of JSON.
    buffers : sequence of bytes
        What it refers to.

    Returns
    -------
    object
        Numbers, text, arrays (copies, writable, little-endian as everywhere here), keypoints,
        matches, lists, tuples, dicts; `Unknown` for what did not cross.

    Raises
    ------
    BadDataError
        When anything is not as `encode` makes it.
    """
    decoder = _Decoder(buffers)
    try:
        return decoder.node(tree, 0)
    except BadDataError:
        raise
    except (KeyError, TypeError, ValueError, IndexError, OverflowError, RecursionError) as error:
        raise BadDataError(f"malformed data: {type(error).__name__}") from error


class _Decoder:
    def __init__(self, buffers: Sequence[bytes | memoryview]) -> None:
        if sum(len(buffer) for buffer in buffers) > MOST_BYTES:
            raise BadDataError("too many bytes")
        self._buffers = buffers
        self._nodes = 0
        self._bytes = 0  # of what was read, as often as it was: a buffer may be named many times

    def node(self, tree: Tree, depth: int) -> Any:  # noqa: ANN401
        self._nodes += 1
        if self._nodes > MOST_NODES or depth > MOST_DEPTH:
            raise BadDataError("too many parts")
        if isinstance(tree, int) and abs(tree) >= 2**63:
            raise BadDataError("a number that no array could hold")
        if tree is None or isinstance(tree, bool | int | float):
            return tree
        if isinstance(tree, str):
            return tree[:MOST_TEXT]
        if not isinstance(tree, Mapping):
            raise BadDataError("neither a value nor a description of one")
        read: dict[str, Callable[[Mapping[str, Any], int], Any]] = {
            "float": lambda tree, _: float(str(tree["v"])[:30]),
            "bytes": lambda tree, _: bytes(self._data(tree)),
            "array": self._array,
            "keypoints": self._keypoints,
            "matches": self._matches,
            "list": self._items,
            "tuple": lambda tree, depth: tuple(self._items(tree, depth)),
            "dict": self._dict,
            "unknown": lambda tree, _: Unknown(str(tree["v"])[:200]),
        }
        return read[str(tree["t"])](tree, depth)

    def _data(self, tree: Mapping[str, Any]) -> memoryview:
        number = tree["b"]
        if type(number) is not int or not 0 <= number < len(self._buffers):
            raise BadDataError("no such buffer")
        data = memoryview(self._buffers[number]).cast("B")
        self._bytes += len(data)
        if self._bytes > MOST_BYTES:
            raise BadDataError("too many bytes")
        return data

    def _items(self, tree: Mapping[str, Any], depth: int) -> list[Any]:
        if not isinstance(tree["v"], list):
            raise BadDataError("a list without items")
        return [self.node(item, depth + 1) for item in tree["v"]]

    def _dict(self, tree: Mapping[str, Any], depth: int) -> dict[Any, Any]:
        if len(tree["v"]) > _MOST_KEYS:
            raise BadDataError("a dict with too many keys")
        pairs = [(self.node(k, depth + 1), self.node(v, depth + 1)) for k, v in tree["v"]]
        return dict(pairs)

    def _array(self, tree: Mapping[str, Any], _depth: int) -> np.ndarray[Any, Any]:
        name, shape, data = tree["d"], tree["s"], self._data(tree)
        if name not in _DTYPES or not isinstance(shape, list) or len(shape) > _MOST_DIMENSIONS:
            raise BadDataError("no such array")
        if not all(type(n) is int and 0 <= n <= MOST_BYTES for n in shape):
            raise BadDataError("no such shape")
        dtype = np.dtype(name)
        if math.prod(shape) * dtype.itemsize != len(data):
            raise BadDataError("the array's size is not its shape's")
        if dtype == np.bool_:  # a byte of 2 would be a truth value that is neither
            return np.asarray(np.frombuffer(data, np.uint8).reshape(shape) != 0)
        array = np.frombuffer(data, dtype.newbyteorder("<")).astype(dtype)
        return array.reshape(shape)

    def _rows(self, tree: Mapping[str, Any], width: int) -> np.ndarray[Any, Any]:
        rows = np.frombuffer(self._data(tree), "<f8").reshape(-1, width)
        if len(rows) > MOST_NODES:
            raise BadDataError("too many records")
        return rows

    def _keypoints(self, tree: Mapping[str, Any], _depth: int) -> Any:  # noqa: ANN401
        rows = self._rows(tree, _KEYPOINT)
        whole = np.nan_to_num(rows[:, 5:], posinf=0, neginf=0).clip(-(2**31), 2**31 - 1)
        items = [
            cv2.KeyPoint(x, y, size, angle, response, int(octave), int(number))
            for (x, y, size, angle, response), (octave, number) in zip(
                rows[:, :5].tolist(), whole.tolist(), strict=True
            )
        ]
        return self._as_sent(tree, items)

    def _matches(self, tree: Mapping[str, Any], _depth: int) -> Any:  # noqa: ANN401
        rows = self._rows(tree, _MATCH)
        whole = np.nan_to_num(rows[:, :3], posinf=-1, neginf=-1).clip(-(2**31), 2**31 - 1)
        items = [
            cv2.DMatch(int(query), int(train), int(image), distance)
            for (query, train, image), distance in zip(
                whole.tolist(), rows[:, 3].tolist(), strict=True
            )
        ]
        return self._as_sent(tree, items)

    @staticmethod
    def _as_sent(tree: Mapping[str, Any], items: list[Any]) -> Any:  # noqa: ANN401
        if tree.get("one") is True:
            return items[0]
        return tuple(items) if tree.get("tuple") is True else items
