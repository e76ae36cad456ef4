"""
Counts what a submission starts where the system does not: root's processes have no limit.

The kernel's process asks for every new process and thread, through a filter on system calls, and
its keeper answers: yes, until there are too many. Once the keeper listens no more, the system says
no by itself. On the same way it asks for changes of modes and times (`modes`).
"""

from __future__ import annotations

import ctypes
import errno
import fcntl
import os
import platform
import select
import struct
import time
from contextlib import suppress
from typing import TYPE_CHECKING

from course_lib.grading.sandbox import modes, processes

if TYPE_CHECKING:
    from collections.abc import Sequence

_CALLS = {"x86_64": (56, 57, 58), "aarch64": (220,)}  # clone, fork, vfork
_SECCOMP = {"x86_64": 317, "aarch64": 277}
_ARCHITECTURES = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}
_LOAD, _EQUAL, _ANSWER = 0x20, 0x15, 0x06
_ASK, _ALLOW, _REFUSE = 0x7FC00000, 0x7FFF0000, 0x00050000 | errno.EPERM
_SET_FILTER, _NEW_LISTENER = 1, 8
_RECEIVE, _SEND, _IS_VALID = 0xC0502100, 0xC0182101, 0x40082102
_QUESTION, _REPLY = "=QIIiIQ6Q", "=QqiI"
_CONTINUE = 1
_PENALTY_SECONDS = 0.005  # who asks for too many waits: else asking alone would keep us busy
_UNSEEN_SECONDS = 0.5  # between what is allowed and what is there, on a busy machine
_libc = ctypes.CDLL(None, use_errno=True)


def ask_for_each() -> int:
    """Let this process, and all that it starts, ask before they start another or change a mode.

    Returns
    -------
    int
        The descriptor on which `Forks` answers; to be closed here before a stranger's code runs.

    Raises
    ------
    OSError
        Where the system cannot, or somebody above listens already; then modes stay as they are.
    """
    machine = platform.machine()
    if machine not in _CALLS:
        raise OSError(errno.ENOSYS, f"no system calls known for {machine}")
    changes = tuple(modes.CALLS[machine])
    try:
        return _filter(machine, (*_CALLS[machine], *changes), _ASK, _NEW_LISTENER)
    except OSError:
        _filter(machine, changes, _REFUSE, 0)
        raise


def _filter(machine: str, calls: tuple[int, ...], answer: int, flags: int) -> int:
    """Give some calls an answer of their own."""

    def step(code: int, value: int, yes: int = 0, no: int = 0) -> bytes:
        return struct.pack("HBBI", code, yes, no, value)

    program = [step(_LOAD, 4), step(_EQUAL, _ARCHITECTURES[machine], 1), step(_ANSWER, _ALLOW)]
    program.append(step(_LOAD, 0))
    program += [step(_EQUAL, call, len(calls) - place) for place, call in enumerate(calls)]
    program += [step(_ANSWER, _ALLOW), step(_ANSWER, answer)]
    code = ctypes.create_string_buffer(b"".join(program))
    filter_ = ctypes.create_string_buffer(
        struct.pack("HxxxxxxP", len(program), ctypes.addressof(code))
    )
    number = ctypes.c_long(_SECCOMP[machine])
    _libc.syscall.restype = ctypes.c_long
    found = _libc.syscall(
        number, ctypes.c_ulong(_SET_FILTER), ctypes.c_ulong(flags), ctypes.byref(filter_)
    )
    if found < 0:
        raise OSError(ctypes.get_errno(), "cannot count new processes")
    return int(found)


class Forks:
    """Answers a submission's questions for more processes.

    Parameters
    ----------
    descriptor : int
        From `ask_for_each`; closed in the end.
    most : int
        Processes and threads at one time.
    folders : sequence of str
        Where its files' modes and times may be changed.
    """

    def __init__(self, descriptor: int, most: int, folders: Sequence[str]) -> None:
        self._modes = modes.Modes(folders)
        self._descriptor = descriptor
        self._most = most
        self._left = 0
        self._on_their_way: dict[int, float] = {}  # who was allowed, and when: not seen yet

    def serve(self, until: int) -> None:
        """Answer until another descriptor has something to read."""
        poll = select.poll()
        for each in (self._descriptor, until):
            poll.register(each, select.POLLIN)
        while True:
            ready = dict(poll.poll())
            if until in ready:
                break
            if ready[self._descriptor] & select.POLLIN == 0:  # all who could ask are gone
                poll.unregister(self._descriptor)
                continue
            with suppress(OSError):  # who asked has been killed meanwhile
                self._answer()
        os.close(self._descriptor)

    def _answer(self) -> None:
        question = bytearray(struct.calcsize(_QUESTION))
        fcntl.ioctl(self._descriptor, _RECEIVE, question)
        number, asking, _, call, _, _, *arguments = struct.unpack_from(_QUESTION, question)
        if call in modes.CALLS[platform.machine()]:
            self._change(number, asking, call, arguments)
            return
        now = time.monotonic()
        self._on_their_way.pop(asking, None)  # has started the last one, and asks for another
        if self._left <= 0:
            self._on_their_way = {
                who: when
                for who, when in self._on_their_way.items()
                if now < when + _UNSEEN_SECONDS
            }
            self._left = self._most - started_by(os.getpid()) - len(self._on_their_way)
        if self._left > 0:
            self._left -= 1
            self._on_their_way[asking] = now
            reply = struct.pack(_REPLY, number, 0, 0, _CONTINUE)
        else:
            time.sleep(_PENALTY_SECONDS)
            reply = struct.pack(_REPLY, number, 0, -errno.EAGAIN, 0)
        fcntl.ioctl(self._descriptor, _SEND, bytearray(reply))

    def _change(self, number: int, asking: int, call: int, arguments: Sequence[int]) -> None:
        def still_asks() -> None:
            fcntl.ioctl(self._descriptor, _IS_VALID, struct.pack("=Q", number))

        error = 0
        try:
            name = modes.CALLS[platform.machine()][call]
            self._modes.change(name, asking, arguments, still_asks)
        except OSError as failure:
            error = failure.errno or errno.EPERM
            time.sleep(_PENALTY_SECONDS)
        reply = struct.pack(_REPLY, number, 0, -error, 0)
        fcntl.ioctl(self._descriptor, _SEND, bytearray(reply))


def started_by(pid: int) -> int:
    """Count the threads of all that a process has started, and who is dead but not buried."""
    found: dict[int, tuple[int, int]] = {}
    for each in processes.everybody():
        with suppress(OSError, ValueError, IndexError):
            fields = processes.fields(each)
            found[each] = int(fields[1]), max(1, int(fields[17]))
    total, waiting = 0, [pid]
    while waiting:
        above = waiting.pop()
        below = [each for each, (parent, _) in found.items() if parent == above]
        total += sum(found[each][1] for each in below)
        waiting += below
    return total
