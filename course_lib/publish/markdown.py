"""Turn a notebook's markdown into HTML that needs nothing from a network.

Formulas become MathML, which browsers set by themselves; links between notebooks become links
between pages; pictures and linked files are taken along.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from html import escape, unescape
from typing import Any

import latex2mathml.converter
import mistune
from nbconvert.filters.markdown_mistune import MarkdownWithMath
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import get_lexer_by_name
from pygments.util import ClassNotFound

# What latex2mathml does not know, in words that it does.
_REWORDED = (
    (re.compile(r"\\operatorname\*?\{([^{}]*)\}"), r"\\text{\1}"),
    (re.compile(r"\\(begin|end)\{aligned\}"), r"\\\1{align*}"),
)
_TAG = re.compile(r"<[^>]+>")
_IMAGE_SOURCE = re.compile(r"""(<img\b[^>]*?\bsrc=)(["'])(.*?)\2""", re.IGNORECASE | re.DOTALL)


@dataclass(frozen=True)
class Heading:
    """A heading of a page: its level (1 to 6), its text and the anchor that leads to it."""

    level: int
    title: str
    anchor: str


def formula(latex: str, *, display: bool) -> str:
    r"""Set a formula as MathML.

    Parameters
    ----------
    latex : str
        LaTeX without its delimiters, such as ``\frac{m_{10}}{m_{00}}``.
    display : bool
        On a line of its own rather than within one.

    Raises
    ------
    ValueError
        The formula cannot be read.
    """
    mode = "block" if display else "inline"
    known = latex.strip()
    for pattern, words in _REWORDED:
        known = pattern.sub(words, known)
    try:
        mathml = latex2mathml.converter.convert(known, display=mode)
    except Exception as error:  # the library has no common base for its errors
        raise ValueError(f"formula {latex.strip()!r} cannot be read: {error!r}") from error
    if unknown := re.search(r"\\\S*?(?=[<\s])", mathml):  # passed through as text
        raise ValueError(f"formula {latex.strip()!r}: {unknown.group()} is not understood")
    return f'<div class="formula">{mathml}</div>' if display else mathml


def highlighted(code: str, language: str = "python") -> str:
    """Return source code as HTML whose spans carry pygments' short class names."""
    try:
        lexer = get_lexer_by_name(language, stripnl=False)
    except ClassNotFound:
        return escape(code)
    return str(highlight(code, lexer, HtmlFormatter(nowrap=True)))


class LessonRenderer(mistune.HTMLRenderer):
    """Writes one page's HTML and remembers its headings.

    Parameters
    ----------
    address : callable
        Given the target of a link or picture as written in the notebook, returns the address to
        use on the page; raises ValueError when the target does not exist.
    """

    def __init__(self, address: Callable[[str], str]) -> None:
        super().__init__(escape=False)
        self.address = address
        self.headings: list[Heading] = []

    def heading(self, text: str, level: int, **attrs: Any) -> str:  # noqa: ARG002, ANN401
        """Write a heading with JupyterLab's anchor, so that links work in both places."""
        title = unescape(_TAG.sub("", text)).strip()
        anchor = title.replace(" ", "-")
        if any(other.anchor == anchor for other in self.headings):
            anchor = f"{anchor}-{len(self.headings)}"
        self.headings.append(Heading(level, title, anchor))
        mark = f'<a class="anchor" href="#{escape(anchor)}" aria-label="Link to this part">#</a>'
        return f'<h{level} id="{escape(anchor)}">{text}{mark}</h{level}>\n'

    def link(self, text: str, url: str, title: str | None = None) -> str:
        """Write a link to where its target stands in the exported course."""
        about = f' title="{escape(title)}"' if title else ""
        return f'<a href="{escape(self.address(unescape(url)))}"{about}>{text}</a>'

    def image(self, text: str, url: str, title: str | None = None) -> str:
        """Write a picture with its alternative text."""
        about = f' title="{escape(title)}"' if title else ""
        source = escape(self.address(unescape(url)))
        return f'<img src="{source}" alt="{escape(_TAG.sub("", text))}"{about}>'

    def _raw(self, html: str) -> str:
        def moved(match: re.Match[str]) -> str:
            return f'{match[1]}"{escape(self.address(unescape(match[3])))}"'

        return _IMAGE_SOURCE.sub(moved, html)

    def inline_html(self, html: str) -> str:
        """Keep HTML as it is, except where pictures lie."""
        return self._raw(html)

    def block_html(self, html: str) -> str:
        """Keep HTML as it is, except where pictures lie."""
        return self._raw(html) + "\n"

    def block_code(self, code: str, info: str | None = None) -> str:
        """Write a block of code, coloured when its language is named."""
        language = (info or "text").split()[0]
        return f'<div class="source"><pre><code>{highlighted(code, language)}</code></pre></div>\n'

    def table(self, text: str) -> str:
        """Write a table that scrolls by itself where it is wider than the screen."""
        return f'<div class="scroll"><table>\n{text}</table></div>\n'

    def block_math(self, body: str) -> str:
        """Write a formula on its own line."""
        return formula(body, display=True)

    def inline_math(self, body: str) -> str:
        """Write a formula within a line."""
        return formula(body, display=False)

    def latex_environment(self, name: str, body: str) -> str:
        r"""Write a formula given as ``\begin{name} … \end{name}``."""
        return formula(rf"\begin{{{name}}}{body}\end{{{name}}}", display=True)

    def paragraph(self, text: str) -> str:
        """Write a paragraph; a formula on its own line is none."""
        stripped = text.strip()
        alone = stripped.startswith('<div class="formula">') and stripped.endswith("</div>")
        return f"{text}\n" if alone else f"<p>{text}</p>\n"


def render(text: str, renderer: LessonRenderer) -> str:
    """Return markdown as HTML; headings are added to the renderer's list.

    Raises
    ------
    ValueError
        A formula cannot be read, or a link's target does not exist.
    """
    return str(MarkdownWithMath(renderer=renderer)(text))
