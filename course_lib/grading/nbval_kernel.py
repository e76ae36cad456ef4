"""What nbval's cells call in place of a kernel of nbval's own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_lib.grading.channel import KernelGoneError

if TYPE_CHECKING:
    from course_lib.grading.channel import Message
    from course_lib.grading.notebook import Notebook


class NbvalKernel:
    """What nbval's cells call, on top of a `Notebook`; stands in for its `RunningKernel`.

    Parameters
    ----------
    notebook : Notebook
        The execution.
    """

    language = "python"

    def __init__(self, notebook: Notebook) -> None:
        self._notebook = notebook

    def is_alive(self) -> bool:
        """Tell whether a cell can be executed; a dead kernel is replaced."""
        try:
            self._notebook.channel()
        except KernelGoneError:
            return False
        return True

    def execute_cell_input(self, source: str, **_: object) -> str:
        """Send a cell."""
        return self._notebook.begin(source)

    def await_reply(self, request: str, timeout: float) -> None:
        """Wait until a cell has ended; `queue.Empty` when that takes too long."""
        self._notebook.reply(request, timeout)

    def get_message(self, stream: str, timeout: float) -> Message:
        """Give the next output message."""
        if stream != "iopub":
            raise ValueError(stream)
        return self._notebook.output(timeout)

    def await_idle(self, request: str, timeout: float) -> None:
        """Read outputs until the cell has ended."""
        while True:
            message = self.get_message("iopub", timeout)
            if message["parent_header"].get("msg_id") == request and (
                message["content"].get("execution_state") == "idle"
            ):
                return

    def interrupt(self) -> None:
        """Stop the running cell."""
        self._notebook.interrupt()

    def stop(self) -> None:
        """Leave the kernel to its notebook, which ends it after the hidden tests."""
