"""Lets jupyter_client start, watch and end a kernel that lives in a sandbox."""

from __future__ import annotations

import asyncio
import signal
from typing import TYPE_CHECKING, Any

from jupyter_client.provisioning.provisioner_base import KernelProvisionerBase

if TYPE_CHECKING:
    from jupyter_client.connect import KernelConnectionInfo

    from course_lib.grading.sandbox.box import Box


class SandboxProvisioner(KernelProvisionerBase):
    """Connects a `KernelManager` with the box in which its kernel runs.

    Attributes
    ----------
    box : Box
        Ready to start the kernel.
    """

    box: Box
    _started = False

    @property
    def has_process(self) -> bool:
        """Whether the kernel was started and not yet cleaned up."""
        return self._started

    async def pre_launch(self, **kwargs: Any) -> dict[str, Any]:  # noqa: ANN401
        """Prepare nothing: no command is executed, the kernel is forked."""
        return {**kwargs, "cmd": []}

    async def launch_kernel(self, cmd: list[str], **_: Any) -> KernelConnectionInfo:  # noqa: ANN401, ARG002
        """Start the kernel on sockets that are already open."""
        manager: Any = self.parent
        self.box.start(manager.session.key.decode())
        self._started = True
        self.connection_info = {
            "transport": "ipc",
            "ip": self.box.address,
            "key": manager.session.key,
            "signature_scheme": manager.session.signature_scheme,
            "shell_port": 1,
            "iopub_port": 2,
            "stdin_port": 3,
            "control_port": 4,
            "hb_port": 5,
        }
        return self.connection_info

    async def poll(self) -> int | None:
        """Give None while the kernel lives."""
        return None if self.box.is_alive() else 1

    async def wait(self) -> int | None:
        """Wait until the kernel has ended."""
        if self.box.is_alive():
            await asyncio.to_thread(self.box.wait)
        return 1

    async def send_signal(self, signum: int) -> None:
        """Send a signal to the kernel and what it runs in the foreground."""
        self.box.signal(signum)

    async def kill(self, restart: bool = False) -> None:  # noqa: ARG002, FBT001, FBT002
        """End everything in the box."""
        self.box.end()

    async def terminate(self, restart: bool = False) -> None:  # noqa: ARG002, FBT001, FBT002
        """Ask the kernel to end."""
        self.box.signal(signal.SIGTERM)

    async def cleanup(self, restart: bool = False) -> None:  # noqa: ARG002, FBT001, FBT002
        """Free what the box holds."""
        self.box.end()
        self._started = False
