"""
Build sample submissions: ``python tests/grading/samples/build.py OUT [KIND/NAME ...]``.

A sample is a folder below ``correct/``, ``mistakes/`` or ``hostile/``. Its ``expected.toml`` says
what grading it must come to; the rest says what is handed in, by any of these:

- ``exercise_4_1.py``, ``exercise_4_2.py``: notebooks as scripts, a cell after each line ``# %%``,
  or ``# %% [markdown]``, whose lines then begin with ``# ``;
- ``like``: another sample, such as ``"correct/short"``, from which this one starts;
- ``first.py``, ``last.py``: cells before and after those of ``hostile/plain_4_1.py``, a right one;
- ``base`` and ``[[edit]]`` (``file``, ``old``, ``new``) in ``expected.toml``: the files that
  ``base`` names, of ``solutions/``, with parts of them replaced;
- ``make.py`` with a function ``make(folder)``, for what no file can say: zip bombs, FIFOs, links;
  it may import this module as ``build``;
- any other file or folder, which is copied.
"""

from __future__ import annotations

import argparse
import importlib.util
import re
import shutil
import tomllib
from pathlib import Path
from typing import Any

import nbformat
from nbformat import v4

HERE = Path(__file__).resolve().parent
SOLUTIONS = HERE.parents[2] / "solutions"
PLAIN = HERE / "hostile" / "plain_4_1.py"
KINDS = ("correct", "mistakes", "hostile")
_CELL = re.compile(r"^# %%(?P<kind> \[markdown\])?[^\n]*\n", re.MULTILINE)
_OURS = {"expected.toml", "make.py", "first.py", "last.py", "__pycache__"}


def names(kind: str | None = None) -> list[str]:
    """List the samples, such as ``"correct/sift"``."""
    kinds = [kind] if kind else KINDS
    found = [path.parent for each in kinds for path in (HERE / each).glob("*/expected.toml")]
    return sorted(f"{path.parent.name}/{path.name}" for path in found)


def expected(name: str) -> dict[str, Any]:
    """Read what grading a sample must come to."""
    return tomllib.loads((HERE / name / "expected.toml").read_text(encoding="utf-8"))


def build(name: str, into: Path) -> Path:
    """Write a sample's submission into a new folder, and return that."""
    source, about = HERE / name, expected(name)
    into.mkdir(parents=True)
    if "like" in about:
        shutil.copytree(build(about["like"], Path(f"{into}.like")), into, dirs_exist_ok=True)
        shutil.rmtree(f"{into}.like")
    around = [source / "first.py", source / "last.py"]
    if any(path.exists() for path in around):
        parts = [path.read_text(encoding="utf-8") for path in around[:1] if path.exists()]
        parts.append(PLAIN.read_text(encoding="utf-8").partition("\n")[2])
        parts += [path.read_text(encoding="utf-8") for path in around[1:] if path.exists()]
        nbformat.write(notebook("\n".join(parts)), into / "exercise_4_1.ipynb")
    for each in about.get("base", []):
        _copy(SOLUTIONS / each, into / each)
    for path in sorted(source.iterdir()):
        if path.name in _OURS:
            continue
        if path.name.startswith("exercise_") and path.suffix == ".py":
            nbformat.write(notebook(path.read_text(encoding="utf-8")), into / f"{path.stem}.ipynb")
        else:
            _copy(path, into / path.name)
    for edit in about.get("edit", []):
        _edit(into / edit["file"], edit["old"], edit["new"])
    if (source / "make.py").exists():
        _module(source / "make.py").make(into)
    return into


def notebook(script: str) -> nbformat.NotebookNode:
    """Make a notebook of a script in which ``# %%`` begins a cell."""
    made = v4.new_notebook()
    pieces = _CELL.split(script)[1:]  # what stands before the first mark is ours
    for number, (kind, text) in enumerate(zip(pieces[::2], pieces[1::2], strict=True)):
        make = v4.new_markdown_cell if kind else v4.new_code_cell
        said = re.sub(r"^# ?", "", text, flags=re.MULTILINE) if kind else text
        made.cells.append(make(said.strip("\n"), id=f"cell-{number}"))
    return made


def hand_in_node(source: str, folder: Path) -> None:
    """Write the least submission of Exercise 4.2 whose finding node is run."""
    script = "# %%\ndef crop_waterhole(frame):\n    return frame"
    nbformat.write(notebook(script), folder / "exercise_4_2.ipynb")
    (folder / "unit4" / "src").mkdir(parents=True)
    (folder / "unit4" / "package.xml").write_text("<package/>")
    node = folder / "unit4" / "src" / "exercise4_2_2.py"
    node.write_text(source)
    node.chmod(0o755)


def _copy(source: Path, target: Path) -> None:
    if source.is_dir():
        shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
    else:
        shutil.copy(source, target)


def _edit(path: Path, old: str, new: str) -> None:
    """Replace what stands exactly once in a file, or in a notebook's code."""
    if path.suffix != ".ipynb":
        text = path.read_text(encoding="utf-8")
        assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in {path.name}"
        path.write_text(text.replace(old, new), encoding="utf-8")
        return
    read = nbformat.read(path, as_version=4)
    hits = [cell for cell in read.cells if cell.cell_type == "code" and old in cell.source]
    assert len(hits) == 1, f"{old!r} is in {len(hits)} cells of {path.name}"
    assert hits[0].source.count(old) == 1, f"{old!r} stands more than once in {path.name}"
    hits[0].source = hits[0].source.replace(old, new)
    nbformat.write(read, path)


def _module(path: Path) -> Any:
    spec = importlib.util.spec_from_file_location(f"sample_{path.parent.name}", path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main() -> None:
    parser = argparse.ArgumentParser(description="Build sample submissions, a folder for each.")
    parser.add_argument("out", type=Path, metavar="OUT", help="a folder; what is built is replaced")
    parser.add_argument("samples", nargs="*", metavar="KIND/NAME", help="only these (all)")
    args = parser.parse_args()
    for name in args.samples or names():
        target = args.out / Path(name).name
        shutil.rmtree(target, ignore_errors=True)
        build(name, target)
        print(target)


if __name__ == "__main__":
    main()
