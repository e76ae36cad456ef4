"""Run notebooks and store their outputs: ``python -m course_lib.publish.execute``.

A notebook is written back only when it ran to its end and satisfies every rule of
`course_lib.publish.lint`; until then the file on disk stays as it was.
"""

import argparse
import os
import sys
from pathlib import Path

from course_lib.publish.lint import lint, lint_file

DEFAULT_FOLDER = Path("notebooks")


def find_notebooks(paths: list[Path]) -> list[Path]:
    """Return the notebooks that a command line means, the index first.

    Parameters
    ----------
    paths : list of Path
        Notebook files and folders; empty for ``notebooks/``.

    Raises
    ------
    FileNotFoundError
        A path does not exist, or nothing was found at all.
    """
    found: list[Path] = []
    for path in paths or [DEFAULT_FOLDER]:
        if path.is_dir():
            # index.ipynb sorts after 4_1_fast.ipynb, but a reader starts with it.
            found += sorted(path.glob("*.ipynb"), key=lambda p: (p.stem != "index", p.name))
        elif path.is_file():
            found.append(path)
        else:
            raise FileNotFoundError(f"{path}: no such notebook or folder")
    if not found:
        raise FileNotFoundError(f"no notebook in {', '.join(map(str, paths or [DEFAULT_FOLDER]))}")
    return found


def store(path: Path, text: str) -> bool:
    """Write a file in one step, and only when its content changes; return whether it did."""
    if path.exists() and path.read_text(encoding="utf-8") == text:
        return False
    draft = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        draft.write_text(text, encoding="utf-8")
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)
    return True


def _check(paths: list[Path]) -> int:
    count = 0
    for path in paths:
        for problem in lint_file(path):
            print(f"{path}: {problem}")  # noqa: T201
            count += 1
    if count == 0:
        print(f"{len(paths)} notebooks are as they should be")  # noqa: T201
    return min(count, 1)


def _execute(paths: list[Path], cell_timeout: float) -> int:
    # Imported late: --help and --check should not wait for kernels' machinery.
    import nbformat  # noqa: PLC0415
    from rich.console import Console  # noqa: PLC0415
    from rich.progress import Progress, TaskID  # noqa: PLC0415

    from course_lib.publish.normalise import normalise  # noqa: PLC0415
    from course_lib.publish.runner import NotebookFailed, run_notebook  # noqa: PLC0415

    failed = 0
    console = Console(highlight=False, soft_wrap=True)
    with Progress(console=console, transient=True) as progress:
        for path in paths:
            bar = progress.add_task(path.name, total=None)

            def cell_done(done: int, of: int, bar: TaskID = bar) -> None:
                progress.update(bar, completed=done, total=of)

            try:
                notebook = run_notebook(
                    path,
                    cell_timeout=cell_timeout,
                    on_cell=cell_done,
                )
            except NotebookFailed as error:
                console.print(str(error), style="red", markup=False)
                failed += 1
                continue
            finally:
                progress.remove_task(bar)
            normalise(notebook)
            nbformat.validate(notebook)
            if problems := lint(notebook):
                for problem in problems:
                    console.print(f"{path}: {problem}", style="red", markup=False)
                console.print(f"{path}: not stored", markup=False)
                failed += 1
                continue
            text = nbformat.writes(notebook)  # type: ignore[no-untyped-call]
            changed = store(path, text.rstrip("\n") + "\n")
            console.print(f"{path}: {'stored' if changed else 'unchanged'}", markup=False)
    return min(failed, 1)


def main(arguments: list[str] | None = None) -> int:
    """Execute or check notebooks; return the exit status (0: all are as they should be)."""
    parser = argparse.ArgumentParser(
        prog="python -m course_lib.publish.execute",
        description="Run notebooks headless, each in its own kernel without network, and store "
        "their outputs in a form that is small and the same every time.",
    )
    parser.add_argument(
        "notebooks", nargs="*", type=Path, help="files or folders (default: notebooks/)"
    )
    parser.add_argument("--check", action="store_true", help="check what is stored, run nothing")
    parser.add_argument(
        "--cell-timeout", type=float, default=120.0, metavar="S", help="seconds per cell (120)"
    )
    options = parser.parse_args(arguments)
    try:
        paths = find_notebooks(options.notebooks)
        return _check(paths) if options.check else _execute(paths, options.cell_timeout)
    except (OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)  # noqa: T201
        return 2
    except KeyboardInterrupt:
        print("stopped; the notebook that was running is unchanged", file=sys.stderr)  # noqa: T201
        return 130


if __name__ == "__main__":
    sys.exit(main())
