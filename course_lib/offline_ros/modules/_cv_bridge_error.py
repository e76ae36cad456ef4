"""The one exception of `cv_bridge`."""

from __future__ import annotations


class CvBridgeError(TypeError):
    """A picture cannot be converted; the message says why."""
