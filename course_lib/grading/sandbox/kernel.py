"""A kernel in its sandbox: its client's channels, and the end of everything that it started."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Self

import zmq
from jupyter_client.blocking.client import BlockingKernelClient
from jupyter_client.kernelspec import KernelSpec
from jupyter_client.manager import KernelManager

from course_lib.grading.sandbox.choice import LimitError, SandboxError
from course_lib.grading.sandbox.provisioner import SandboxProvisioner

if TYPE_CHECKING:
    from types import TracebackType

    from course_lib.grading.sandbox.box import Box

_READY_SECONDS = 30.0
_MOST_MESSAGE = 96 * 2**20  # bytes; a message above ends the connection
_SEND_MILLISECONDS = 1000  # nobody may be there any more to whom it could be sent


class SandboxedKernel:
    """A kernel in its sandbox; a context manager that ends it.

    Attributes
    ----------
    manager : KernelManager
    client : BlockingKernelClient
        Shell and output channels connected.
    events : list of str
        Limits that were exceeded.
    """

    def __init__(self, box: Box) -> None:
        self._box = box
        self.events = box.events
        self._context = zmq.Context()
        for option, value in (
            (zmq.MAXMSGSIZE, _MOST_MESSAGE),
            (zmq.LINGER, 0),
            (zmq.RECONNECT_IVL, -1),
            (zmq.SNDTIMEO, _SEND_MILLISECONDS),
        ):
            self._context.setsockopt(option, value)
        self.manager = KernelManager(
            transport="ipc", ip=box.address, context=self._context, autorestart=False
        )
        self.manager._kernel_spec = KernelSpec(language="python", display_name="sandbox")  # noqa: SLF001
        provisioner = SandboxProvisioner(
            kernel_id="sandbox", kernel_spec=self.manager.kernel_spec, parent=self.manager
        )
        provisioner.box = box
        self.manager.provisioner = provisioner
        try:
            self.manager.start_kernel()
            self.client = self._connect()
        except BaseException:
            self.close()
            raise

    def _connect(self) -> BlockingKernelClient:
        client = BlockingKernelClient(
            transport="ipc",
            ip=self._box.address,
            shell_port=1,
            iopub_port=2,
            stdin_port=3,
            control_port=4,
            context=self._context,
            session=self.manager.session,
        )
        client.start_channels(stdin=False, hb=False, control=False)
        # Outputs are missed until the subscription has arrived: ask until an answer is heard.
        deadline = time.monotonic() + _READY_SECONDS
        while time.monotonic() < deadline and self.is_alive():
            client.kernel_info()
            if client.shell_channel.socket.poll(5000) and client.iopub_channel.socket.poll(20):
                _empty(client)
                return client
        if self.events:  # what was handed in fills the folder, say
            raise LimitError(", ".join(self.events))
        raise SandboxError("the kernel did not start: no answer")

    def is_alive(self) -> bool:
        """Tell whether the kernel's process lives."""
        return self._box.is_alive()

    def interrupt(self) -> None:
        """Send the kernel and what it runs in the foreground an interrupt."""
        self.manager.interrupt_kernel()

    def kill(self) -> None:
        """End everything the submission started, at once."""
        self._box.end()

    def close(self) -> None:
        """End everything; on return no process, socket or file of the sandbox is left."""
        if hasattr(self, "client"):
            self.client.stop_channels()
        self._box.close()
        self.manager._close_control_socket()  # noqa: SLF001
        self._context.destroy(linger=0)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _empty(client: BlockingKernelClient) -> None:
    for channel in (client.shell_channel, client.iopub_channel):
        while channel.socket.poll(0):
            channel.socket.recv_multipart(zmq.NOBLOCK)
