"""Render every picture again: `python images/render/render_all.py [--only NAME] [--preview]`.

Every script of this folder that has a `main(out, *, preview)` is a scene.
Each runs in a process of its own, so that none sees what another left in Blender.
One that reads another's picture says so with a line such as `AFTER = "peppers"`.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import time
from graphlib import TopologicalSorter
from pathlib import Path

HERE = Path(__file__).resolve().parent


def scenes() -> list[str]:
    """Return the names of the scene scripts: alphabetical, but each after what it reads.

    Returns
    -------
    list of str

    Raises
    ------
    graphlib.CycleError
        If two scenes wait for each other.
    """
    order: TopologicalSorter[str] = TopologicalSorter()
    for path in sorted(HERE.glob("*.py")):
        text = path.read_text(encoding="utf-8")
        if "\ndef main(out: Path" in text:
            order.add(path.stem, *re.findall(r'^AFTER = "(\w+)"$', text, re.MULTILINE))
    return list(order.static_order())


def main() -> int:
    """Render; return 0 when every scene came out.

    Returns
    -------
    int
    """
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--only", action="append", metavar="NAME", choices=scenes())
    parser.add_argument("--preview", action="store_true", help="small and rough, in seconds")
    parser.add_argument("--out", type=Path, default=HERE.parent, help="default: images/")
    options = parser.parse_args()
    names = [name for name in scenes() if not options.only or name in options.only]
    failed = []
    for number, name in enumerate(names, 1):
        print(f"[{number}/{len(names)}] {name}", flush=True)
        begun = time.monotonic()
        call = (
            f"import pathlib, sys, {name} as scene;"
            f"scene.main(pathlib.Path(sys.argv[1]), preview={options.preview})"
        )
        done = subprocess.run(  # noqa: S603 - our own scripts
            [sys.executable, "-c", call, str(options.out.resolve())],
            cwd=HERE,
            env=os.environ | {"PYTHONPATH": str(HERE.parents[1])},
            check=False,
            stdout=subprocess.DEVNULL,
        )
        outcome = "FAILED" if done.returncode else "done"
        print(f"    {outcome} in {time.monotonic() - begun:.0f} s")
        if done.returncode:
            failed.append(name)
    if failed:
        print("failed:", ", ".join(failed))
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
