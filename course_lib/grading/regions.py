"""
Solution regions: what `course release` takes out of the source of truth, and what it leaves.

A region stands between two comment lines of its own. Their form says what replaces it::

    ### BEGIN SOLUTION: sort them by distance        raise NotImplementedError("sort them by …")
    ...                                         ->
    ### END SOLUTION

    # BEGIN SOLUTION: name the package               # Your part: name the package
    ...                                         ->
    # END SOLUTION

    <!-- BEGIN SOLUTION: start the node -->          <!-- Your part: start the node -->
    ...                                         ->
    <!-- END SOLUTION -->

Three hashes stand for Python that has to run, one for any file with ``#`` comments. The hint after
the colon may be left out. The form counts, not the kind of file: a notebook may hold an XML or
CMake file in a string.
"""

from __future__ import annotations

import json
import re

NO_HINT = "this part is yours to write"
_BEGIN = re.compile(
    r"(?P<indent>[ \t]*)(?P<form>###|#|<!--)[ \t]*BEGIN SOLUTION"
    r"(?::[ \t]*(?P<hint>.*?))?[ \t]*(?P<close>-->)?[ \t]*"
)
_END = re.compile(r"[ \t]*(?P<form>###|#|<!--)[ \t]*END SOLUTION[ \t]*(?P<close>-->)?[ \t]*")
_ANY = re.compile(r"(?:BEGIN|END)[\W_]*SOLUTION", re.IGNORECASE)


class ReleaseError(ValueError):
    """A file of ``solutions/`` that cannot be released as it is; the message says why."""


def without_solutions(text: str, where: str) -> str:
    """
    Replace every solution region of a text by its stub.

    Parameters
    ----------
    text : str
        A file, or the source of a notebook's cell.
    where : str
        Its name, for messages.

    Returns
    -------
    str

    Raises
    ------
    ReleaseError
        A mark that is not closed, not opened, nested or misspelt.

    Examples
    --------
    >>> print(without_solutions('''def f():
    ...     ### BEGIN SOLUTION: add both
    ...     return 1 + 1
    ...     ### END SOLUTION''', "cell"))
    def f():
        raise NotImplementedError("add both")
    """
    kept: list[str] = []
    opened: re.Match[str] | None = None
    for number, line in enumerate(text.split("\n"), start=1):
        place = f"{where}, line {number}"
        begin, end = _BEGIN.fullmatch(line), _END.fullmatch(line)
        if begin:
            if opened:
                raise ReleaseError(f"{place}: a solution begins within a solution")
            kept.append(_stub(begin))
            opened = begin
        elif end:
            if not opened or opened["form"] != end["form"]:
                raise ReleaseError(f"{place}: this END SOLUTION has no BEGIN of the same form")
            opened = None
        elif _ANY.search(line):
            raise ReleaseError(f"{place}: {line.strip()!r} looks like a mark, but is misspelt")
        elif not opened:
            kept.append(line)
    if opened:
        raise ReleaseError(f"{where}: a solution begins and never ends")
    return "\n".join(kept)


def solutions(text: str) -> list[str]:
    """Return what stands in the solution regions of a text, one string for each region."""
    found: list[list[str]] = []
    inside = False
    for line in text.split("\n"):
        if _BEGIN.fullmatch(line):
            found.append([])
            inside = True
        elif _END.fullmatch(line):
            inside = False
        elif inside:
            found[-1].append(line)
    return ["\n".join(lines) for lines in found]


def _stub(begin: re.Match[str]) -> str:
    hint = begin["hint"] or NO_HINT
    if begin["form"] == "###":
        return f"{begin['indent']}raise NotImplementedError({json.dumps(hint, ensure_ascii=False)})"
    if begin["form"] == "#":
        return f"{begin['indent']}# Your part: {hint}"
    return f"{begin['indent']}<!-- Your part: {hint} -->"
