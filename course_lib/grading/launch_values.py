"""The names and values of a launch file, as roslaunch makes them of its text."""

from __future__ import annotations

import shlex
from contextlib import suppress
from typing import Any

# Known only where the node runs; what runs it puts the folders there.
PACKAGE_FOLDER, HOME_FOLDER = "$(find unit4)", "$(env HOME)"
_FOLDERS = (PACKAGE_FOLDER, HOME_FOLDER)
_TRUTH = {"true": True, "1": True, "false": False, "0": False}


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


def converted(text: str, kind: str = "auto") -> Any:  # noqa: ANN401
    """Make of a text what roslaunch makes of it, unless it is YAML.

    Parameters
    ----------
    text : str
    kind : str, optional
        A parameter's `type`.

    Returns
    -------
    object

    Raises
    ------
    ValueError
        When it is none of that type, or there is no such type: roslaunch starts nothing then.
    """
    lowered = text.strip().lower()
    match kind.lower():
        case "auto":
            return _guessed(text)
        case "str" | "string":
            return text
        case "int":
            return int(text)
        case "double":
            return float(text)
        case "bool" | "boolean" if lowered in _TRUTH:
            return _TRUTH[lowered]
    raise ValueError(f"{text!r} is no {kind}")


def _guessed(text: str) -> Any:  # noqa: ANN401
    with suppress(ValueError):
        if "." in text:  # so 1e3 stays a text
            return float(text)
        if "_" not in text:  # 1_000 is a number for Python only
            return int(text)
    lowered = text.lower()
    return _TRUTH[lowered] if lowered in {"true", "false"} else text
