"""
Messages between the grader's own processes: JSON and blobs of bytes, with their lengths before.

Both ends are ours, and still only data crosses: nothing is unpickled, and sizes have a limit.
"""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

Message = tuple[dict[str, Any], list[bytes]]

_HEAD = struct.Struct(">II")  # bytes of JSON, number of blobs
_SIZE = struct.Struct(">I")
MOST_BYTES = 512 * 2**20
_MOST_BLOBS = 4096


class Link(Protocol):
    """What can be read from: a socket."""

    def recv(self, most: int, /) -> bytes:
        """Give some bytes, none at the end."""


class BrokenMessageError(ValueError):
    """What arrived is no message of ours."""


def pack(content: Mapping[str, Any], blobs: Sequence[bytes] = ()) -> bytes:
    """Make the bytes of a message.

    Parameters
    ----------
    content : mapping
        JSON's own types. Lone surrogates (odd file names) survive.
    blobs : sequence of bytes, optional
        Travel as they are.

    Raises
    ------
    BrokenMessageError
        When it is larger than a reader would accept.
    """
    text = json.dumps(content, allow_nan=True).encode("ascii")
    if len(blobs) > _MOST_BLOBS or len(text) + sum(map(len, blobs)) > MOST_BYTES:
        raise BrokenMessageError("the message is too large")
    sizes = b"".join(_SIZE.pack(len(blob)) for blob in blobs)
    return b"".join([_HEAD.pack(len(text), len(blobs)), sizes, text, *blobs])


def unpack(data: bytes) -> Message:
    """Read what `pack` made.

    Raises
    ------
    BrokenMessageError
        When it is anything else.
    """
    reader = _Bytes(data)
    try:
        message = receive(reader)
    except EOFError as error:
        raise BrokenMessageError("the message is cut off") from error
    if reader.recv(1):
        raise BrokenMessageError("something follows the message")
    return message


def receive(link: Link) -> Message:
    """Read one message from a socket.

    Raises
    ------
    EOFError
        When the other side hung up.
    BrokenMessageError
        When what arrives is no message.
    """
    length, count = _HEAD.unpack(_exactly(link, _HEAD.size))
    if count > _MOST_BLOBS or length > MOST_BYTES:
        raise BrokenMessageError("the message is too large")
    sizes = [_SIZE.unpack(_exactly(link, _SIZE.size))[0] for _ in range(count)]
    if length + sum(sizes) > MOST_BYTES:
        raise BrokenMessageError("the message is too large")
    try:
        content = json.loads(_exactly(link, length))
    except (ValueError, RecursionError) as error:
        raise BrokenMessageError("the message is no JSON") from error
    if not isinstance(content, dict):
        raise BrokenMessageError("the message is no object")
    return content, [_exactly(link, size) for size in sizes]


def _exactly(link: Link, size: int) -> bytes:
    chunks, left = [], size
    while left:
        chunk = link.recv(min(left, 1 << 20))
        if not chunk:
            raise EOFError
        chunks.append(chunk)
        left -= len(chunk)
    return b"".join(chunks)


class _Bytes:
    def __init__(self, data: bytes) -> None:
        self._data = memoryview(data)

    def recv(self, most: int, /) -> bytes:
        chunk, self._data = bytes(self._data[:most]), self._data[most:]
        return chunk
