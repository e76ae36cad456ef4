"""An IPython kernel that cannot reach a network.

Started as ``python -m course_lib.publish.offline_kernel -f CONNECTION_FILE``. The kernel talks to
its client over Unix sockets, so it can give up its network before any notebook code runs.
"""

import ctypes
import os
import sys
from pathlib import Path
from typing import Any

CLONE_NEWUSER = 0x10000000
CLONE_NEWNET = 0x40000000


def leave_network() -> bool:
    """Move this process into a network namespace without interfaces.

    Returns
    -------
    bool
        False where the system allows neither root's nor an unprivileged user's namespace; the
        audit hook of `refuse_connections` then stands alone.
    """
    if sys.platform != "linux":
        return False
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(CLONE_NEWNET) == 0:
        return True
    user, group = os.getuid(), os.getgid()
    if libc.unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0:
        return False
    # Keep our own ids inside, or files we write would belong to "nobody".
    Path("/proc/self/setgroups").write_text("deny", encoding="ascii")
    Path("/proc/self/uid_map").write_text(f"{user} {user} 1", encoding="ascii")
    Path("/proc/self/gid_map").write_text(f"{group} {group} 1", encoding="ascii")
    return True


def refuse_connections() -> None:
    """Make any internet address that Python code connects to or resolves a clear error."""

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        if event in {"socket.connect", "socket.sendto"} and isinstance(arguments[1], tuple):
            address = arguments[1]
        elif event == "socket.getaddrinfo":
            address = arguments[:2]
        else:
            return
        if address[0] not in {"127.0.0.1", "::1", "localhost", None}:
            raise PermissionError(
                f"a course notebook runs without network, but this cell wants {address[0]!r}"
            )

    sys.addaudithook(hook)


def main() -> None:
    """Give up the network, then be a kernel."""
    leave_network()
    refuse_connections()
    from ipykernel import kernelapp  # noqa: PLC0415  (after the network is gone)

    kernelapp.launch_new_instance()


if __name__ == "__main__":
    main()
