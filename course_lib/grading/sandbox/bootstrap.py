"""Runs an IPython kernel on sockets that somebody else has opened, the grader's agent in it."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from typing import Any

import zmq
from ipykernel.iostream import IOPubThread
from ipykernel.kernelapp import IPKernelApp
from IPython.core import pylabtools
from matplotlib_inline import backend_inline

from course_lib.grading import agent
from course_lib.grading.sandbox.semaphores import make_do_without_shared_memory

_PIXELS = {"png", "png2x", "retina", "jpg", "jpeg"}


class _App(IPKernelApp):
    listeners: dict[int, int]  # port: descriptor

    def _try_bind_socket(self, s: Any, port: int) -> int:  # noqa: ANN401
        """Bind to the open socket: no path is looked up, so none can be swapped."""
        if port in self.listeners:
            s.setsockopt(zmq.USE_FD, self.listeners[port])
        return int(super()._try_bind_socket(s, port))  # type: ignore[no-untyped-call]

    def parse_command_line(self, argv: Any = None) -> None:  # noqa: ANN401
        """Read none: there is none, and making its parser takes long."""

    def init_signal(self) -> None:
        """Leave signals as they are: an interrupt is handled while a request is."""

    def init_crash_handler(self) -> None:
        """Write no crash report."""

    def write_connection_file(self, **_: object) -> None:
        """Write nothing: the launcher knows."""

    def log_connection_info(self) -> None:
        """Say nothing."""


def run(connection: dict[str, Any], listeners: list[int], *, loopback: bool) -> None:
    """Run a kernel until it is killed.

    Parameters
    ----------
    connection : dict
        `key`, and `ip`, the prefix of the sockets' paths.
    listeners : list of int
        Open, listening sockets in the order of `places.CHANNELS`.
    loopback : bool
        Whether sockets on the machine's own address are allowed; without them, what a forked
        child prints is not heard.
    """
    if not loopback:
        IOPubThread._setup_pipe_in = _no_pipe  # type: ignore[method-assign]  # noqa: SLF001
    sys.argv = ["kernel"]
    app = _App.instance()
    app.ignore_cwd = True
    app.listeners = dict(enumerate(listeners, start=1))
    app.transport, app.ip = "ipc", connection["ip"]
    app.shell_port, app.iopub_port, app.stdin_port, app.control_port, app.hb_port = 1, 2, 3, 4, 5
    app.session.key = connection["key"].encode()
    app.config.HistoryManager.enabled = False
    app.config.IPKernelApp.parent_handle = 0
    app.initialize([])  # type: ignore[no-untyped-call]
    # matplotlib was imported before there was a shell: tell each of the other.
    shell: Any = app.shell
    _draw_as_png_too()
    shell.enable_matplotlib("inline")
    _run_commands_without_terminal(shell)
    make_do_without_shared_memory()
    agent.install(app)
    if "" not in sys.path:  # not before: a student may well have a file called code.py
        sys.path.insert(0, "")
    app.start()  # type: ignore[no-untyped-call]


def _draw_as_png_too() -> None:
    """Let figures be sent as PNG whatever format a notebook asks for: that is what is looked at."""
    usual = pylabtools.select_figure_formats

    def select(shell: Any, formats: Any, **how: Any) -> None:  # noqa: ANN401
        asked = {formats} if isinstance(formats, str) else set(formats)
        usual(shell, asked if asked & _PIXELS else asked | {"png"}, **how)  # type: ignore[no-untyped-call]

    for module in (pylabtools, backend_inline):
        module.select_figure_formats = select  # type: ignore[attr-defined]


def _run_commands_without_terminal(shell: Any) -> None:  # noqa: ANN401
    """Let `!command` work where IPython gets no pseudo-terminal for it, as under Landlock."""
    with contextlib.suppress(OSError):
        for descriptor in os.openpty():
            os.close(descriptor)
        return

    def system(command: str) -> None:
        done = subprocess.run(  # noqa: S602  (the student's own shell command)
            shell.var_expand(command, depth=1),
            shell=True,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            check=False,
        )
        print(done.stdout.decode(errors="replace"), end="")  # noqa: T201
        shell.user_ns["_exit_code"] = done.returncode

    shell.system = system


def _no_pipe(thread: Any) -> None:  # noqa: ANN401
    thread._pipe_flag = False  # noqa: SLF001
