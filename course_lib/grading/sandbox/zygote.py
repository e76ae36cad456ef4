"""
A warm interpreter that forks kernels: what takes a second to import is imported once.

It is executed anew, or forked from the `nursery`, with a clean environment, and never sees a test,
a seed or a submission; its only visitor is the launcher. For each request it forks a keeper. The
keeper steps into the container, or confines itself, gives up its powers and forks the kernel, and
then answers with a handle on it.

A request is one message: JSON, and with it the descriptors of a socket for the answer, of the
container's first process, of four listening sockets and of the working folder.
"""

from __future__ import annotations

import importlib
import json
import os
import signal
import socket
import sys
import traceback
from contextlib import suppress
from typing import Any

from course_lib.grading import lean
from course_lib.grading.sandbox import keeper

_WARM = (
    "IPython.core.completer",
    "IPython.core.completerlib",
    "IPython.core.debugger",
    "IPython.core.logger",
    "IPython.core.magics",
    "IPython.core.magics.ast_mod",
    "IPython.core.magics.execution",
    "IPython.core.oinspect",
    "IPython.extensions.storemagic",
    "PIL.BmpImagePlugin",  # Pillow looks for these at its first picture
    "PIL.GifImagePlugin",
    "PIL.JpegImagePlugin",
    "PIL.PpmImagePlugin",
    "course_lib.display",
    "course_lib.drawing",
    "course_lib.grading.sandbox.bootstrap",
    "course_lib.localize",
    "faulthandler",
    "ipykernel.ipkernel",
    "matplotlib.pyplot",
    "matplotlib_inline.backend_inline",
    "pdb",
    "stack_data",  # for the first traceback
    "tornado.platform.asyncio",
    "zmq.utils.garbage",
)
_WARM_FOR_NODES = "course_lib.grading.node_run"
_MOST_REQUEST = 1 << 16
_MOST_DESCRIPTORS = 7


def main() -> None:
    """Serve the launcher on the socket whose number is the one argument."""
    control = socket.socket(fileno=int(sys.argv[1]))
    warm_up()
    serve(control)


def serve(control: socket.socket) -> None:
    """Fork kernels until the launcher hangs up.

    Parameters
    ----------
    control : socket
        To the launcher.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal's Ctrl-C is the grader's business
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # keepers need no waiting for
    control.send(b"ready")
    while True:
        message, descriptors, _, _ = socket.recv_fds(control, _MOST_REQUEST, _MOST_DESCRIPTORS)
        if not message:
            return
        if os.fork() == 0:
            control.close()
            _keep(json.loads(message), descriptors)
            os._exit(0)
        for descriptor in descriptors:
            os.close(descriptor)


def warm_up(*, nodes: bool = True) -> None:
    """Import what kernels will need. No thread may start here: only then can a child step over.

    Parameters
    ----------
    nodes : bool, optional
        Whether ROS nodes will run; a kernel that was not prepared for it can do it all the same.
    """
    with lean.for_good():
        with lean.without("debugpy"):  # nobody attaches; each kernel would import it anew
            importlib.import_module("ipykernel.debugger")
        for name in (*_WARM, _WARM_FOR_NODES) if nodes else _WARM:
            importlib.import_module(name)
        # Matplotlib reads the metadata of every installed package to find `inline`, and remembers.
        backends = importlib.import_module("matplotlib.backends.registry")
        backends.backend_registry.resolve_gui_or_backend("inline")


def _keep(request: dict[str, Any], descriptors: list[int]) -> None:
    """Become the keeper of one kernel, and answer the launcher."""
    answer = socket.socket(fileno=descriptors[0])
    try:
        keeper.start(request, descriptors[1:], answer)
    except BaseException:  # noqa: BLE001  (the launcher must hear of anything)
        with suppress(OSError):
            answer.send(traceback.format_exc(limit=-3).encode()[-4000:])


if __name__ == "__main__":
    main()
