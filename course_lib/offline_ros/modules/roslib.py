"""`roslib`: only the call that old nodes begin with."""

from __future__ import annotations


def load_manifest(package_name: str) -> None:
    """Do nothing: Python already finds what a node imports."""
    _ = package_name
