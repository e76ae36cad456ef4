"""The names and values of a launch file, as roslaunch makes them of its text."""

from __future__ import annotations

import shlex
from typing import Any

# Known only where the node runs; what runs it puts the folders there.
PACKAGE_FOLDER, HOME_FOLDER = "$(find unit4)", "$(env HOME)"
_FOLDERS = (PACKAGE_FOLDER, HOME_FOLDER)


def split_words(text: str) -> list[str]:
    """Split arguments as a shell does, without splitting the folders' names, which have blanks."""
    for number, folder in enumerate(_FOLDERS):
        text = text.replace(folder, f"\0{number}")
    try:
        words = shlex.split(text)
    except ValueError:
        return []
    for number, folder in enumerate(_FOLDERS):
        words = [word.replace(f"\0{number}", folder) for word in words]
    return words


def joined(outer: str, inner: str) -> str:
    """Return a namespace within another, without outer slashes."""
    return inner.strip("/") if inner.startswith("/") else f"{outer}/{inner}".strip("/")


def parameter_key(name: str, *, within: bool) -> str:
    """Return a parameter's name: private ones bare, others from the root."""
    if within or name.startswith("~"):
        return name.lstrip("~/")
    return "/" + name.lstrip("/")


def typed(value: str, kind: str) -> Any:  # noqa: ANN401
    """Turn a parameter's text into what roslaunch makes of it, unless it is YAML."""
    if kind in {"str", "string"}:
        return value
    if kind in {"", "auto", "int"}:
        try:
            return int(value)
        except ValueError:
            pass
    if kind in {"", "auto", "int", "double"}:
        try:
            return float(value)
        except ValueError:
            pass
    lowered = value.strip().lower()
    return lowered == "true" if lowered in {"true", "false"} else value
