"""The assignment that all graders get: the student's notebook, the checks, the pictures."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import cv2
import nbformat
from graders import checks
from nbformat.v4 import new_code_cell, new_notebook

from course_lib import images

HERE = Path(__file__).parent
CHECKS = HERE / "checks.py"
NAME = "exercise_4_1"
SIZES = {"mug.png": ("ROS.png", 400, 600), "shelf.png": ("ROS2.png", 600, 400)}
# Right in what is asked of the parts, wrong wherever the mug is to be found.
WRONG = "\n\ndef locate_mug(mug, scene, match_count=100):\n    return np.zeros((4, 2))\n"
FULL_SCORE, WRONG_SCORE = 8, 3


@dataclass(frozen=True)
class Check:
    """One check or test: its name, its source, and whether it is hidden from the student."""

    name: str
    source: str
    hidden: bool


def all_checks() -> list[Check]:
    """List the four public checks and the four hidden tests."""
    functions = [(each, False) for each in checks.PUBLIC] + [(each, True) for each in checks.HIDDEN]
    _, *sources = CHECKS.read_text("utf-8").partition("\n\n\nPUBLIC =")[0].split("\n\n\ndef check_")
    by_name = {f"check_{text.partition('(')[0]}": f"def check_{text}\n" for text in sources}
    return [Check(f.__name__, by_name[f.__name__], hidden) for f, hidden in functions]


def helpers() -> str:
    """Give what the checks' functions need."""
    return CHECKS.read_text("utf-8").partition("\n\n\ndef check_")[0]


def cells(student: str, *, wrong: bool = False) -> list[str]:
    """Give the code cells of a student, no two students' alike."""
    first, *rest = (HERE / "solution.py").read_text("utf-8").split("# %%\n")[1:]
    if wrong:
        rest[-2] += WRONG
    return [f"# {student}\n{first.strip()}", *(cell.strip() for cell in rest)]


def notebook(sources: list[str], metadata: list[dict[str, object]] | None = None):
    """Make a notebook of code cells."""
    metadata = metadata or [{} for _ in sources]
    made = [
        new_code_cell(source, metadata=each) for source, each in zip(sources, metadata, strict=True)
    ]
    for number, cell in enumerate(made):
        cell.id = f"cell-{number}"
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return new_notebook(cells=made, metadata={"kernelspec": kernel})


def write(made, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(made, path)


def put_pictures(folder: Path) -> None:
    """Put the two pictures where a notebook or the checks read them."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in _pictures().items():
        (folder / name).write_bytes(data)


@cache
def _pictures() -> dict[str, bytes]:
    return {
        name: cv2.imencode(".png", images.resize(images.load(source), *size))[1].tobytes()
        for name, (source, *size) in SIZES.items()
    }
