"""What can go wrong while a node runs offline."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from course_lib.offline_ros.recording import Recording


class OfflineRosError(Exception):
    """Base of this package's own errors; the message names the cause and the fix."""


class UnsupportedError(AttributeError, OfflineRosError):
    """A part of the ROS API that exists but that `offline_ros` does not provide."""

    def __init__(self, name: str, advice: str) -> None:
        super().__init__(f"{name} is not supported by offline_ros; {advice}")


class BagError(OfflineRosError):
    """The bag is missing, unreadable or holds nothing to play."""


class NodeError(OfflineRosError):
    """The node crashed or had to be stopped.

    Attributes
    ----------
    traceback : str
        The node's own traceback, or where it was when it was stopped; may be empty.
    recording : Recording or None
        What the node had published, logged and shown until then.
    """

    def __init__(
        self, message: str, *, traceback: str = "", recording: Recording | None = None
    ) -> None:
        super().__init__(f"{message}\n\n{traceback}".rstrip())
        self.traceback = traceback
        self.recording = recording
