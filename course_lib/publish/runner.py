"""Run one notebook from its first cell to its last in a kernel of its own."""

import asyncio
import logging
import os
import re
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import nbformat
from jupyter_client.kernelspec import KernelSpec
from jupyter_client.manager import AsyncKernelManager
from jupyter_core.utils import ensure_async
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, CellTimeoutError, DeadKernelError
from traitlets.config import Config

from course_lib.publish.normalise import merge_streams

_ANSI = re.compile(r"\x1b\[[0-9;]*m")


class NotebookFailed(Exception):  # noqa: N818  (reads as the sentence it begins)
    """A notebook did not run to its end; the message names the notebook and shows the cell."""


class OfflineKernelManager(AsyncKernelManager):
    """Starts the kernel of `offline_kernel` in this very environment, whatever is registered."""

    @property
    def kernel_spec(self) -> KernelSpec:
        """The kernel's command line: this interpreter, so no kernelspec can point elsewhere."""
        module = "course_lib.publish.offline_kernel"
        return KernelSpec(
            argv=[sys.executable, "-m", module, "-f", "{connection_file}", "--log-level=50"],
            display_name="Python 3 (offline)",
            language="python",
        )


class InterruptibleClient(NotebookClient):
    """nbclient, except that Ctrl-C ends the kernel at once and leaves nothing behind.

    nbclient's own handler cleans up a kernel that it then cleans up again, which fails.
    """

    stopped = False

    async def async_start_new_kernel(self, **options: Any) -> None:  # noqa: ANN401
        """Start the kernel, with signals that cancel the run."""
        task, loop = asyncio.current_task(), asyncio.get_running_loop()

        def stop() -> None:
            # A graceful end waits for the cell that was interrupted.
            self.shutdown_kernel = "immediate"
            self.stopped = True
            if task is not None:
                task.cancel()

        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                loop.add_signal_handler(number, stop)
        await super().async_start_new_kernel(**options)

    async def run(self, **options: Any) -> None:  # noqa: ANN401
        """Execute every cell; whatever happens, no kernel is left when this returns."""
        try:
            await self.async_execute(**options)
        finally:
            if self.km is not None and await ensure_async(self.km.is_alive()):
                await ensure_async(self.km.shutdown_kernel(now=True))


def _run(work: Coroutine[Any, Any, None]) -> None:
    """Run a coroutine to its end, also where an event loop runs already, as in a notebook."""
    try:
        asyncio.get_running_loop()
    except RuntimeError:
        asyncio.run(work)
        return
    with ThreadPoolExecutor(1) as thread:
        thread.submit(asyncio.run, work).result()


def run_notebook(
    path: Path,
    *,
    notebook: nbformat.NotebookNode | None = None,
    cell_timeout: float = 120.0,
    keep_widget_state: bool = False,
    on_cell: Callable[[int, int], None] | None = None,
) -> nbformat.NotebookNode:
    """Execute a notebook without network and return it with its outputs.

    Parameters
    ----------
    path : Path
        The notebook; its folder is the kernel's working directory.
    notebook : nbformat.NotebookNode, optional
        Run this, a version 4.5, in the place of what the file holds.
    cell_timeout : float
        Seconds that one cell may take.
    keep_widget_state : bool
        Put every widget's state in ``metadata.widgets``, as an exported page needs it.
    on_cell : callable, optional
        Called with (cells done, cells in all) as cells finish.

    Returns
    -------
    nbformat.NotebookNode
        The executed notebook, as version 4.5; the file itself is untouched.

    Raises
    ------
    NotebookFailed
        A cell raised, took too long, or the kernel died.
    KeyboardInterrupt
        Ctrl-C or SIGTERM; the kernel is gone by then.
    """
    path = path.resolve()
    notebook = notebook or nbformat.read(path, as_version=4)  # type: ignore[no-untyped-call]
    count = len(notebook.cells)

    def cell_done(cell_index: int, **_: Any) -> None:  # noqa: ANN401
        if on_cell is not None:
            on_cell(cell_index + 1, count)

    # A kernel that dies is reported below, in one sentence, instead of in log lines.
    logging.getLogger("traitlets").setLevel(logging.CRITICAL)
    with tempfile.TemporaryDirectory(prefix="course-") as folder:
        sockets = {"transport": "ipc", "connection_file": str(Path(folder) / "kernel.json")}
        client = InterruptibleClient(
            notebook,
            config=Config({"OfflineKernelManager": sockets}),
            kernel_manager_class=OfflineKernelManager,
            kernel_name="python3",
            timeout=cell_timeout,
            startup_timeout=60,
            record_timing=False,
            store_widget_state=keep_widget_state,
            resources={"metadata": {"path": str(path.parent)}},
            on_cell_complete=cell_done,
        )
        environment = {**os.environ, "MPLBACKEND": "module://matplotlib_inline.backend_inline"}
        try:
            _run(client.run(env=environment))
        except asyncio.CancelledError:
            raise KeyboardInterrupt from None
        except CellExecutionError as error:
            text = _ANSI.sub("", str(error))  # also reaches logs and files
            raise NotebookFailed(f"{path.name}: a cell raised\n{text}") from error
        except CellTimeoutError as error:
            message = f"{path.name}: a cell took longer than {cell_timeout:g} s\n{error}"
            raise NotebookFailed(message) from error
        except DeadKernelError as error:  # also a RuntimeError, so it comes first
            if client.stopped:  # nbclient takes a cancelled cell for a dead kernel
                raise KeyboardInterrupt from None
            raise NotebookFailed(f"{path.name}: the kernel died\n{error}") from error
        except RuntimeError as error:
            help_text = "is the course installed in this Python? `make notebooks` sees to it"
            raise NotebookFailed(f"{path.name}: {error}; {help_text}") from error
    for cell in notebook.cells:
        merge_streams(cell)
    return notebook
