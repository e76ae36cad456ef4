"""
Build a class of sample submissions: ``python tests/grading/samples/make_class.py OUT``.

``class.toml`` says who hands in what: one sample, or one for each exercise. OUT is replaced.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
import tomllib
from pathlib import Path

import build

CLASS = Path(__file__).with_name("class.toml")


def make(out: Path) -> list[Path]:
    """Write a folder for each student, and return them."""
    shutil.rmtree(out, ignore_errors=True)
    folders = []
    with tempfile.TemporaryDirectory() as scratch:
        for student, samples in tomllib.loads(CLASS.read_text(encoding="utf-8")).items():
            for number, name in enumerate(samples):
                part = build.build(name, Path(scratch) / f"{student} {number}")
                # Links and pipes stay what they are.
                shutil.copytree(part, out / student, symlinks=True, dirs_exist_ok=True)
            folders.append(out / student)
    return folders


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Build a class of sample submissions.")
    parser.add_argument("out", type=Path, metavar="OUT", help="a folder; it is replaced")
    made = make(parser.parse_args().out)
    print(f"{len(made)} sample submissions in {made[0].parent}")
