"""Cuts Python code into tokens for comparing; takes anything, and takes time linear in its length.

Not the standard library's tokenizer: that gives up on broken code, and from Python 3.12 on it cuts
an f-string differently, so that graders of two versions would not agree.
"""

from __future__ import annotations

import builtins
import keyword
import re

_TOKEN = re.compile(
    r"""
    (?P<blank>(?:[^\S\n]|\\\n|\\|\#[^\n]*)++)
  | (?P<line>\n)
  | (?P<text>(?i:[rbuf]{0,2})(?:
        \"\"\"(?:[^"\\]|\\.|"(?!""))*+(?:\"\"\"|\Z)
      | '''(?:[^'\\]|\\.|'(?!''))*+(?:'''|\Z)
      | "(?:[^"\\\n]|\\.)*+"?
      | '(?:[^'\\\n]|\\.)*+'?))
  | (?P<number>\.?\d[\w.]*+)
  | (?P<name>[^\W\d]\w*+)
  | (?P<sign>\*\*=?|//=?|<<=?|>>=?|->|[-+*/%@&|^~<>=!:]=|.)
    """,
    re.VERBOSE | re.DOTALL,
)
# Magics, shell lines and imports say nothing about who wrote the code.
_NOT_CODE = re.compile(
    r"(?m)^[ \t]*+(?:[%!].*"
    r"|import\b.*"
    r"|from[ \t]++[\w.]++[ \t]++import\b[^\n(]*+(?:\([^)]{0,2000}\))?)"
)
# Names that no one can change; all others are marked with a dollar, to be numbered later.
_FIXED = frozenset(keyword.kwlist) | frozenset(dir(builtins))


def tokens(code: str) -> list[str]:
    """Cut code into tokens.

    Parameters
    ----------
    code : str
        A cell or a file; it may be broken, and hold magics.

    Returns
    -------
    list of str
        Without blanks, comments, docstrings, imports and magics. Every text is ``"s"``, every
        number ``"0"``; a name that its writer chose begins with ``$``.

    Examples
    --------
    >>> tokens("total = cv2.norm(a, 'b')  # far?")
    ['$total', '=', '$cv2', '.', 'norm', '(', '$a', ',', 's', ')']
    """
    found: list[str] = []
    depth, starts_line = 0, True
    for match in _TOKEN.finditer(_NOT_CODE.sub("", code)):
        kind, word = match.lastgroup, match.group()
        if kind == "blank":
            continue
        if kind == "line":
            starts_line = True
            continue
        if kind == "text":
            # A text that begins a statement is a docstring.
            if not (starts_line and depth == 0):
                found.append("s")
        elif kind == "number":
            found.append("0")
        elif kind == "name":
            follows_dot = bool(found) and found[-1] == "."
            found.append(word if follows_dot or word in _FIXED else f"${word}")
        else:
            depth += (word in "([{") - (word in ")]}")
            depth = max(depth, 0)
            found.append(word)
        starts_line = False
    return found
