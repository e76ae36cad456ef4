"""Reads XML that a stranger wrote: limited in size, without entities."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

MOST_BYTES = 200_000
_LATIN_1 = re.compile(
    rb"""<\?xml[^>]*encoding=["'](?:iso-8859-1|latin-?1|windows-1252)["']""", re.IGNORECASE
)


_MOST_READ = 2 * MOST_BYTES  # of all files together
_COST_OF_YAML = 10  # its reader is slow


class LaunchError(ValueError):
    """A launch file that cannot be read, worded for its writer."""


class Allowance:
    """How much a launch file may still take in: it may name the same file again and again."""

    def __init__(self) -> None:
        self._left = _MOST_READ

    def take(self, text: bytes | str, *, yaml: bool = False) -> None:
        """Count what is about to be read.

        Raises
        ------
        LaunchError
            When it is too much.
        """
        self._left -= len(text) * (_COST_OF_YAML if yaml else 1)
        if self._left < 0:
            raise LaunchError("is, with all that it loads, far too large for what it is")


def read_xml(data: bytes) -> ET.Element:
    """Read an XML file that a stranger wrote.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    xml.etree.ElementTree.Element
        Its root.

    Raises
    ------
    LaunchError
        Too large, not UTF-8, with a document type (entities could make it grow), not well-formed.
    """
    if len(data) > MOST_BYTES:
        raise LaunchError("is far too large for what it is")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        if not _LATIN_1.match(data):
            raise LaunchError("cannot be read as text: save it as UTF-8") from None
        text = data.decode("latin-1")
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise LaunchError("declares a document type or entities, which ROS does not need")
    try:
        return ET.fromstring(text)  # noqa: S314  (no entities, limited in size)
    except (ET.ParseError, ValueError, RecursionError) as error:
        raise LaunchError(f"is not well-formed XML: {error}") from None
