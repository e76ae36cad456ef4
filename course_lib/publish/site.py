"""Export the course as HTML: ``python -m course_lib.publish.site``.

The pages need no kernel, no server and no network: open ``site/index.html`` from the disk.
"""

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from course_lib.publish.execute import find_notebooks

COURSE = "Feature Matching, hands on"
MARK = ".exported-course"
_HERE = Path(__file__).parent
_SCRIPTS = ("models.js", "controls.js", "page.js")


def _check_target(out: Path) -> None:
    if out.exists() and not (out / MARK).is_file() and (not out.is_dir() or any(out.iterdir())):
        raise ValueError(f"{out} holds something that is no exported course; give another --out")


def build(notebooks: list[Path], out: Path, *, cell_timeout: float = 120.0) -> list[Path]:
    """Execute notebooks and write them as a site; an earlier site in `out` is replaced.

    Parameters
    ----------
    notebooks : list of Path
        In the order in which they are read.
    out : Path
        Folder to write; it changes only when every notebook has been exported.
    cell_timeout : float
        Seconds that one cell may take.

    Returns
    -------
    list of Path
        The pages.

    Raises
    ------
    NotebookFailed
        A notebook did not run to its end.
    ValueError
        A page would be incomplete (see `page.Exporter.export`), or `out` is somebody else's.
    """
    # Imported late, so that --help answers at once.
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # noqa: PLC0415
    from rich.console import Console  # noqa: PLC0415
    from rich.progress import Progress, TaskID  # noqa: PLC0415

    from course_lib.publish.page import Exporter  # noqa: PLC0415
    from course_lib.publish.runner import run_notebook  # noqa: PLC0415

    _check_target(out)
    exporter = Exporter({path.resolve(): f"{path.stem}.html" for path in notebooks})
    pages = []
    with Progress(console=Console(stderr=True), transient=True) as progress:
        for path in notebooks:
            bar = progress.add_task(path.name, total=None)

            def cell_done(done: int, of: int, bar: TaskID = bar) -> None:
                progress.update(bar, completed=done, total=of)

            executed = run_notebook(
                path, cell_timeout=cell_timeout, keep_widget_state=True, on_cell=cell_done
            )
            pages.append(exporter.export(path, executed))

    environment = Environment(
        loader=FileSystemLoader(_HERE / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    template = environment.get_template("page.html.j2")
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{out.name}-", dir=out.parent) as folder:
        draft = Path(folder) / "site"
        (draft / "files").mkdir(parents=True)
        (draft / MARK).touch()
        for number, page in enumerate(pages):
            html = template.render(
                course=COURSE,
                page=page,
                pages=pages,
                before=pages[number - 1] if number else None,
                after=pages[number + 1] if number + 1 < len(pages) else None,
            )
            (draft / page.address).write_text(html, encoding="utf-8")
        for address, content in exporter.files.items():
            (draft / address).write_bytes(content)
        static = _HERE / "static"
        # One classic script: browsers refuse modules to a page opened from the disk.
        script = "\n".join((static / name).read_text(encoding="utf-8") for name in _SCRIPTS)
        (draft / "course.js").write_text(script, encoding="utf-8")
        shutil.copy(static / "course.css", draft)
        if out.exists():
            out.rename(Path(folder) / "old")
        draft.rename(out)
    return [out / page.address for page in pages]


def main(arguments: list[str] | None = None) -> int:
    """Export the course; return the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m course_lib.publish.site",
        description="Execute the notebooks and export them as HTML pages whose sliders answer "
        "without a kernel, a server or a network.",
    )
    parser.add_argument(
        "notebooks", nargs="*", type=Path, help="files or folders (default: notebooks/)"
    )
    parser.add_argument(
        "--out", type=Path, default=Path("site"), metavar="DIR", help="where to write (site)"
    )
    parser.add_argument(
        "--cell-timeout", type=float, default=120.0, metavar="S", help="seconds per cell (120)"
    )
    options = parser.parse_args(arguments)
    try:
        from course_lib.publish.runner import NotebookFailed  # noqa: PLC0415
    except KeyboardInterrupt:
        return 130
    try:
        pages = build(
            find_notebooks(options.notebooks), options.out, cell_timeout=options.cell_timeout
        )
    except (OSError, ValueError, NotebookFailed) as error:
        print(f"error: {error}", file=sys.stderr)  # noqa: T201
        return 1
    except KeyboardInterrupt:
        print("stopped; an earlier export is unchanged", file=sys.stderr)  # noqa: T201
        return 130
    print(f"{len(pages)} pages; open {pages[0]}")  # noqa: T201
    return 0


if __name__ == "__main__":
    sys.exit(main())
