"""
Holds students' code: it shares no process, no writable file, no network and no secret with us.

`Launcher` starts kernels in a sandbox: bubblewrap's namespaces, or Landlock through sandlock, each
with a filter on system calls, resource limits and a watcher. What a submission started is gone when
its kernel is closed.

Without namespaces (sandlock) a submission can still see that other processes exist and share the
machine's clock and process table; it can neither signal nor inspect them, nor reach the network,
nor read anything but the interpreter, the course and its own folder.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_lib.grading.sandbox.choice import (
    LimitError,
    NoSandboxError,
    SandboxError,
    choose,
)
from course_lib.grading.sandbox.limits import Limits

if TYPE_CHECKING:
    from course_lib.grading.sandbox.kernel import SandboxedKernel
    from course_lib.grading.sandbox.launcher import Launcher

__all__ = [
    "Launcher",
    "LimitError",
    "Limits",
    "NoSandboxError",
    "SandboxError",
    "SandboxedKernel",
    "choose",
]


def __getattr__(name: str) -> object:
    """Import what starts kernels when it is wanted: who only hands out work does without."""
    if name in {"Launcher", "SandboxedKernel"}:
        from course_lib.grading.sandbox import kernel, launcher  # noqa: PLC0415

        return launcher.Launcher if name == "Launcher" else kernel.SandboxedKernel
    raise AttributeError(name)
