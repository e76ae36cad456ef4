"""
Messages with a kernel that is not trusted: every wait has an end, every flood a dam.

The kernel's own signing key is known to the student's code, so a message proves nothing about who
wrote it. What is read here is bounded in number and size, and malformed messages are dropped.
"""

from __future__ import annotations

import time
from collections import deque
from contextlib import suppress
from queue import Empty
from typing import TYPE_CHECKING, Any

import zmq

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jupyter_client.blocking.client import BlockingKernelClient

    from course_lib.grading.sandbox import SandboxedKernel

Message = dict[str, Any]

_MOST_QUEUED = 2000  # messages of one cell that are kept
_MOST_GARBAGE = 1000
_MOST_TEXT = 20_000  # characters of one stream message
_PART_BYTES = 64  # what a message's part takes, however short
_DRAIN_SECONDS = 1.0


class KernelGoneError(Exception):
    """The kernel died, or was ended for breaking a limit."""


class Channel:
    """The shell and output channels of one sandboxed kernel.

    Parameters
    ----------
    kernel : SandboxedKernel
        Ready.
    output_bytes : int
        Most bytes of output of the whole submission; beyond, the kernel is ended.

    Attributes
    ----------
    events : list of str
        Limits that were hit here.
    ended : bool
        Whether the kernel was ended for it.
    """

    def __init__(self, kernel: SandboxedKernel, output_bytes: int) -> None:
        self.kernel = kernel
        self.events: list[str] = []
        self.ended = False
        self._client: BlockingKernelClient = kernel.client
        self._most = self._left = output_bytes
        self._garbage = 0
        self._outputs: deque[Message] = deque(maxlen=_MOST_QUEUED)
        self._replies: deque[Message] = deque(maxlen=100)
        self._poller = zmq.Poller()
        self._shell = self._client.shell_channel.socket
        self._iopub = self._client.iopub_channel.socket
        for socket in (self._shell, self._iopub):
            self._poller.register(socket, zmq.POLLIN)

    def send(self, kind: str, content: Message, buffers: Sequence[bytes] = ()) -> str:
        """Send a request on the shell channel and give its message id.

        Raises
        ------
        KernelGoneError
            When the kernel has closed its end, though its process may live on.
        """
        session = self._client.session
        message = session.msg(kind, content)
        try:
            session.send(self._shell, message, buffers=list(buffers))
        except zmq.Again:
            self._end("hung up on the grader")
        return str(message["header"]["msg_id"])

    def reply(self, message_id: str, kind: str, deadline: float) -> Message:
        """Wait for the reply to a request, keeping outputs that arrive in between.

        Raises
        ------
        queue.Empty
            When the deadline (on `time.monotonic`) passed.
        KernelGoneError
            When the kernel died.
        """
        while True:
            while self._replies:
                message = self._replies.popleft()
                if _answers(message, message_id) and message.get("msg_type") == kind:
                    return message
            self._wait(deadline)

    def output(self, deadline: float) -> Message:
        """Give the next message of the output channel.

        Raises
        ------
        queue.Empty
            When the deadline (on `time.monotonic`) passed.
        KernelGoneError
            When the kernel died.
        """
        while not self._outputs:
            self._wait(deadline)
        return self._outputs.popleft()

    def drain(self) -> None:
        """Read and drop whatever has arrived."""
        end = time.monotonic() + _DRAIN_SECONDS
        with suppress(Empty, KernelGoneError):
            while time.monotonic() < end:
                self._wait(time.monotonic())
        self._outputs.clear()
        self._replies.clear()

    def _wait(self, deadline: float) -> None:
        """Read what has arrived; look now and then whether the kernel still lives."""
        while True:
            left = deadline - time.monotonic()
            ready = dict(self._poller.poll(int(max(0.0, min(left, 0.2)) * 1000)))
            if ready:
                break
            if self.ended or not self.kernel.is_alive():
                raise KernelGoneError
            if left <= 0:
                raise Empty
        if self._iopub in ready:
            self._receive(self._iopub, self._outputs)
        if self._shell in ready:
            self._receive(self._shell, self._replies)
        if time.monotonic() > deadline + 1:  # a flood never lets the poller rest
            raise Empty

    def _receive(self, socket: Any, queue: deque[Message]) -> None:  # noqa: ANN401
        try:
            parts = socket.recv_multipart(zmq.NOBLOCK, copy=True)
        except zmq.Again:
            return
        self._left -= sum(map(len, parts)) + _PART_BYTES * len(parts)
        if self._left < 0:
            self._end(f"output limit of {self._most // 2**20} MB")
        try:
            _, parts = self._client.session.feed_identities(parts)
            message = self._client.session.deserialize(parts)
            queue.append(_harmless(message))
        except Exception:  # noqa: BLE001  (a forged message may break any step of reading it)
            self._garbage += 1
            if self._garbage > _MOST_GARBAGE:
                self._end(f"more than {_MOST_GARBAGE} malformed messages")

    def _end(self, reason: str) -> None:
        self.ended = True
        self.events.append(reason)
        self.kernel.kill()
        raise KernelGoneError(reason)


def _answers(message: Message, message_id: str) -> bool:
    return bool(message["parent_header"].get("msg_id") == message_id)


def _harmless(message: Message) -> Message:
    """Check the parts that nbval uses without looking, and shorten floods of text.

    Raises
    ------
    TypeError
        When a part is missing or of another type.
    """
    kind, content, parent = message["msg_type"], message["content"], message["parent_header"]
    if not (isinstance(kind, str) and isinstance(content, dict) and isinstance(parent, dict)):
        raise TypeError("not a message")
    needed: dict[str, dict[str, type]] = {
        "status": {"execution_state": str},
        "stream": {"name": str, "text": str},
        "display_data": {"data": dict, "metadata": dict},
        "execute_result": {"data": dict, "metadata": dict},
        "error": {"ename": str, "evalue": str, "traceback": list},
        "execute_reply": {"status": str},
    }
    for name, expected in needed.get(kind, {}).items():
        if not isinstance(content[name], expected):
            raise TypeError(f"{kind} without {name}")
    if kind == "stream":
        content["text"] = content["text"][:_MOST_TEXT]
    if kind == "error":
        content["traceback"] = [str(line)[:2000] for line in content["traceback"][:50]]
    content.setdefault("execution_count", None)
    return message
