"""What a stored notebook of the course must and must not hold.

The rules keep three promises: the file reads well on GitHub and in nbviewer (a still picture beside
every widget, alternative text beside every picture), nbval can compare its text (no addresses,
no paths of one machine), and nothing in it is known to stall a headless run.
"""

import ast
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from course_lib.publish.normalise import PNG, WIDGET_VIEW, outputs_of

MAX_CODE_LINES = 15
MAX_OUTPUT_BYTES = 200_000
MAX_NOTEBOOK_BYTES = 1_500_000

# Each ties the kernel to the page by messages: headless runs stall on them, exports freeze.
STALLING = {"interact", "interact_manual", "interactive", "interactive_output", "Output"}
_ADDRESS = re.compile(r"\bat 0x[0-9a-fA-F]+")
_MACHINE_PATH = re.compile(r"(?<![\w.])/(?:home|root|tmp|Users|work|mnt)/[\w.-]+")
_MARKDOWN_IMAGE = re.compile(r"!\[(?P<alt>[^\]]*)\]\((?P<target>[^)\s]+)")
_HTML_IMAGE = re.compile(r"<img\b[^>]*>", re.IGNORECASE)
_FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def join(text: Any) -> str:  # noqa: ANN401
    """Return notebook text, which may be stored as a list of lines, as one string."""
    return text if isinstance(text, str) else "".join(text)


def alt_text(output: Any, mime: str = PNG) -> str:  # noqa: ANN401
    """Return the text alternative of a picture in an output, or "" when it has none.

    `course_lib.drawing` stores it in the metadata (``{"image/png": {"alt": …}}``); a viewer, whose
    metadata ipywidgets writes, has it as its plain text.
    """
    about = output.get("metadata", {}).get(mime, {})
    if isinstance(about, dict) and about.get("alt", "").strip():
        return str(about["alt"]).strip()
    plain = join(output.get("data", {}).get("text/plain", "")).strip()
    # "<Figure size 640x480 with 1 Axes>" and "VBox(children=…)" describe nothing to anybody.
    is_repr = plain.startswith("<") or re.match(r"\w+\(", plain)
    return "" if is_repr or WIDGET_VIEW not in output.get("data", {}) else plain


def _lint_source(source: str) -> Iterator[str]:
    lines = [line for line in source.splitlines() if line.strip()]
    if len(lines) > MAX_CODE_LINES:
        yield f"has {len(lines)} lines of code; at most {MAX_CODE_LINES} fit a reader's eye"
    if any(line.lstrip().startswith(("%", "!")) for line in lines):
        yield "uses a magic or shell command; say it in Python, or with a cell tag"
        return
    try:
        tree = ast.parse(source)
    except SyntaxError as error:
        yield f"is not Python: {error.msg} (line {error.lineno})"
        return
    for node in ast.walk(tree):
        name = getattr(node, "id", None) or getattr(node, "attr", None)
        if isinstance(node, ast.alias):
            name = node.name
        if name in STALLING:
            yield f"uses {name}, which stalls headless runs; link a slider with jslink instead"


def _lint_output(output: Any) -> Iterator[str]:  # noqa: ANN401
    kind, data = output["output_type"], output.get("data", {})
    size = len(json.dumps(output))
    if size > MAX_OUTPUT_BYTES:
        yield f"stores an output of {size:,} bytes; at most {MAX_OUTPUT_BYTES:,}"
    if kind == "stream" and output.get("name") == "stderr":
        first = join(output["text"]).strip().splitlines()[:1]
        yield f"writes to stderr: {' '.join(first)!r}"
    if WIDGET_VIEW in data and PNG not in data:
        yield "shows a widget without a still picture (image/png) for readers without a kernel"
    for mime in data:
        if mime.startswith("image/") and not alt_text(output, mime):
            yield f"shows a picture ({mime}) without alternative text; pass alt=… to drawing.show"
    if "text/html" in data:
        yield from _lint_images(join(data["text/html"]))
    plain = join(output.get("text", "")) + join(data.get("text/plain", ""))
    if match := _ADDRESS.search(plain) or _MACHINE_PATH.search(plain):
        yield f"prints {match.group()!r}, which differs from run to run or machine to machine"


def _lint_images(text: str) -> Iterator[str]:
    text = _FENCE.sub("", text)
    for match in _MARKDOWN_IMAGE.finditer(text):
        if not match["alt"].strip():
            yield f"shows {match['target']} without alternative text"
        if "://" in match["target"]:
            yield f"shows {match['target']} from the network; keep pictures in the repository"
    for tag in _HTML_IMAGE.findall(text):
        if not re.search(r"""alt=["'][^"']+""", tag):
            yield f"shows {tag} without alternative text"
        if re.search(r"""src=["'](?:https?:)?//""", tag):
            yield f"shows {tag} from the network; keep pictures in the repository"


def _lint_code_cell(cell: Any) -> Iterator[str]:  # noqa: ANN401
    yield from _lint_source(join(cell["source"]))
    tags = cell["metadata"].get("tags", [])
    if join(cell["source"]).strip() and cell.get("execution_count") is None:
        yield "was never executed, so nbval would not compare it"
    for output in outputs_of(cell):
        if output["output_type"] == "error":
            if "raises-exception" not in tags:
                yield f"raised {output['ename']}: {output['evalue']}"
        else:
            yield from _lint_output(output)


def lint(notebook: Any) -> list[str]:  # noqa: ANN401
    """List what is wrong with a notebook as stored; an empty list when all is well.

    Parameters
    ----------
    notebook : dict
        The notebook's JSON (nbformat 4.5), as `json.load` or `nbformat.read` give it.

    Returns
    -------
    list of str
        One sentence each, beginning with the cell's number (from 1) and id.
    """
    problems: list[str] = []
    version = (notebook.get("nbformat"), notebook.get("nbformat_minor"))
    if version != (4, 5):
        return [f"is stored as nbformat {version[0]}.{version[1]}; the course uses 4.5"]
    if "widgets" in notebook["metadata"]:
        problems.append("stores widget state (metadata.widgets), which GitHub may refuse to show")
    ids = [cell.get("id") for cell in notebook["cells"]]
    problems.extend(f"has more than one cell with id {i!r}" for i in set(ids) if ids.count(i) > 1)
    for number, cell in enumerate(notebook["cells"], start=1):
        check = _lint_code_cell(cell) if cell["cell_type"] == "code" else None
        found = check if check is not None else _lint_images(join(cell["source"]))
        problems.extend(f"cell {number} ({cell.get('id')}) {problem}" for problem in found)
    return problems


def lint_file(path: Path) -> list[str]:
    """List what is wrong with a notebook file, its size included.

    Raises
    ------
    OSError, ValueError
        The file is missing or is not JSON.
    """
    text = path.read_text(encoding="utf-8")
    problems = lint(json.loads(text))
    if len(text.encode()) > MAX_NOTEBOOK_BYTES:
        limit = f"at most {MAX_NOTEBOOK_BYTES:,}"
        problems.append(f"is {len(text.encode()):,} bytes; {limit}")
    return problems
