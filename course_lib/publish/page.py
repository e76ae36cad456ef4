"""One notebook as one HTML page of the exported course."""

import base64
import hashlib
import re
import struct
from dataclasses import dataclass, field
from html import escape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from course_lib.publish.lint import alt_text, join
from course_lib.publish.markdown import Heading, LessonRenderer, formula, highlighted, render
from course_lib.publish.normalise import WIDGET_VIEW, outputs_of
from course_lib.publish.widgets import page_state

_ANSI = re.compile(r"\x1b\[[0-9;]*m")
_PICTURES = {"image/png": "png", "image/jpeg": "jpg"}


@dataclass
class Page:
    """What the template needs of a page."""

    address: str
    title: str
    body: str
    sections: list[Heading]
    widget_state: str


@dataclass
class Exporter:
    """Turns executed notebooks into pages and gathers the files that they need.

    Attributes
    ----------
    pages : dict
        Resolved path of every notebook of the course to the address of its page.
    files : dict
        Address to content of every picture and linked file.
    """

    pages: dict[Path, str]
    files: dict[str, bytes] = field(default_factory=dict)

    def keep(self, name: str, content: bytes) -> str:
        """Take a file along; return its address. The same content is kept once."""
        digest = hashlib.sha256(content).hexdigest()[:10]
        address = f"files/{digest}-{name}"
        self.files[address] = content
        return address

    def address(self, target: str, notebook: Path) -> str:
        """Return where a link or picture of a notebook leads on its page.

        Raises
        ------
        ValueError
            The target is a file that does not exist.
        """
        parts = urlsplit(target)
        if parts.scheme or parts.netloc or not parts.path:
            return target
        path = (notebook.parent / unquote(parts.path)).resolve()
        anchor = f"#{parts.fragment}" if parts.fragment else ""
        if path in self.pages:
            return self.pages[path] + anchor
        if not path.is_file():
            raise ValueError(f"it links to {target!r}, which is not a file")
        return self.keep(path.name, path.read_bytes()) + anchor

    def export(self, path: Path, notebook: Any) -> Page:  # noqa: ANN401
        """Turn an executed notebook, with its widget state, into a page.

        Parameters
        ----------
        path : Path
            Where the notebook lies; its links are relative to this.
        notebook : nbformat.NotebookNode
            As `runner.run_notebook` returns it with ``keep_widget_state=True``.

        Raises
        ------
        ValueError
            A picture has no alternative text, a link leads nowhere, something would be fetched
            from a network, or a widget cannot be shown. The message names the notebook.
        """
        path = path.resolve()
        renderer = LessonRenderer(lambda target: self.address(target, path))
        parts = []
        for number, cell in enumerate(notebook["cells"], start=1):
            try:
                parts.append(self._cell(cell, renderer))
            except ValueError as error:
                raise ValueError(f"{path.name}, cell {number}: {error}") from error
        body = "\n".join(parts)
        if faults := list_faults(body):
            raise ValueError(f"{path.name}: {'; '.join(faults)}")
        headings = renderer.headings
        title = next((h.title for h in headings if h.level == 1), path.stem)
        try:
            state = page_state(notebook)
        except ValueError as error:
            raise ValueError(f"{path.name}: {error}") from error
        return Page(self.pages[path], title, body, [h for h in headings if h.level == 2], state)

    def _cell(self, cell: Any, renderer: LessonRenderer) -> str:  # noqa: ANN401
        source = join(cell["source"])
        if cell["cell_type"] == "markdown":
            return f'<div class="prose">{render(source, renderer)}</div>'
        if cell["cell_type"] != "code":
            return ""
        outputs = "\n".join(self._output(output) for output in outputs_of(cell))
        shown = f'<div class="outputs">{outputs}</div>' if outputs else ""
        if not source.strip():
            return shown
        code = f"<pre><code>{highlighted(source)}</code></pre>"
        # The code of a question holds its answer.
        is_question = source.lstrip().startswith("quiz.")
        if is_question or cell["metadata"].get("jupyter", {}).get("source_hidden"):
            code = f'<details class="source"><summary>Show the code</summary>{code}</details>'
        else:
            code = f'<div class="source">{code}</div>'
        return code + shown

    def _output(self, output: Any) -> str:  # noqa: ANN401
        if output["output_type"] == "stream":
            return f"<pre>{escape(_ANSI.sub('', join(output['text'])))}</pre>"
        if output["output_type"] == "error":
            traceback = _ANSI.sub("", "\n".join(output["traceback"]))
            return f'<pre class="error">{escape(traceback)}</pre>'
        data = output["data"]
        picture = "".join(self._picture(output, mime) for mime in _PICTURES if mime in data)
        if WIDGET_VIEW in data:
            model = escape(data[WIDGET_VIEW]["model_id"])
            return f'<div class="widget" data-model="{model}">{picture}</div>'
        if "text/html" in data:
            return f'<div class="scroll">{join(data["text/html"])}</div>'
        if picture:
            return picture
        if "text/latex" in data:
            return formula(join(data["text/latex"]).strip().strip("$"), display=True)
        return f"<pre>{escape(_ANSI.sub('', join(data.get('text/plain', ''))))}</pre>"

    def _picture(self, output: Any, mime: str) -> str:  # noqa: ANN401
        content = base64.b64decode(join(output["data"][mime]))
        source = self.keep(f"picture.{_PICTURES[mime]}", content)
        about = output.get("metadata", {}).get(mime, {})
        size = {name: about[name] for name in ("width", "height") if name in about}
        if not size and mime == "image/png":
            # Known before the file is loaded, so the page does not jump.
            size = dict(zip(("width", "height"), struct.unpack(">II", content[16:24]), strict=True))
        sizes = "".join(f' {name}="{int(value)}"' for name, value in size.items())
        alt = escape(alt_text(output, mime))
        return f'<figure><img src="{source}" alt="{alt}"{sizes}></figure>'


class _Faults(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        if tag == "img" and not values.get("alt", "").strip():
            self.found.append(f"picture {values.get('src')} has no alternative text")
        # A link waits for its reader; everything else is fetched as the page opens.
        fetched = [values.get(name, "") for name in ("src", "srcset", "poster", "data")]
        if tag not in {"a", "area"}:
            fetched.append(values.get("href", ""))
        self.found.extend(
            f"<{tag}> would be fetched from the network: {address}"
            for address in fetched
            if re.match(r"(?:https?:)?//", address)
        )


def list_faults(html: str) -> list[str]:
    """List pictures without alternative text and everything that a network would have to give."""
    parser = _Faults()
    parser.feed(html)
    return parser.found
