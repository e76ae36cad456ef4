"""Makes text that a stranger wrote fit to be shown: no escape codes, no floods."""

from __future__ import annotations

import re
import unicodedata

_ESCAPES = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)?|[@-Z\\-_])")


def clean(text: str, limit: int = 2000) -> str:
    """Clean a text of terminal codes, control and direction characters, and shorten it.

    Parameters
    ----------
    text : str
        Anything.
    limit : int, optional
        Most characters to keep.

    Returns
    -------
    str
        Plain text of at most `limit` characters; it still must be escaped for HTML.
    """
    # Only what may be kept is looked at: a pattern run over a flood would take its time.
    head = _ESCAPES.sub("", text[: limit * 4]).replace("\r\n", "\n")
    kept = "".join(
        character
        for character in head
        if character in "\n\t" or unicodedata.category(character) not in {"Cc", "Cf", "Cs", "Co"}
    )
    if len(kept) > limit:
        return kept[: limit - 1] + "…"
    return kept + ("…" if len(text) > limit * 4 else "")
