"""Every notebook of the course keeps the course's rules, as stored."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from course_lib.publish.lint import join, lint_file

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
LESSONS = [path for path in NOTEBOOKS if path.stem != "index"]
SECTIONS = [
    r"^## What you will see and learn",
    r"\*\*Time:\*\*",
    r"\*\*Prerequisites:\*\*",
    r"^## The idea",
    r"^> ### Corrected from the unit",
    r"^\*\*What to notice\*\*",
    r"^## When it breaks",
    r"^## Questions",
    r"^## Take away",
    r"^## Further reading",
]


def name(path: Path) -> str:
    return path.stem


def cells(path: Path, kind: str) -> list[str]:
    notebook = json.loads(path.read_text(encoding="utf-8"))
    return [join(c["source"]) for c in notebook["cells"] if c["cell_type"] == kind]


def test_all_five_examples_and_the_index_are_there() -> None:
    examples = ["4_1_fast", "4_2_nonmax", "4_3_brief", "4_4_orb_matching", "4_5_drone", "index"]
    assert [path.stem for path in NOTEBOOKS] == examples


@pytest.mark.parametrize("path", NOTEBOOKS, ids=name)
def test_stored_notebook_satisfies_the_lint(path: Path) -> None:
    assert lint_file(path) == []


@pytest.mark.parametrize("path", LESSONS, ids=name)
@pytest.mark.parametrize("pattern", SECTIONS)
def test_lesson_has_section(path: Path, pattern: str) -> None:
    assert re.search(pattern, "\n".join(cells(path, "markdown")), re.MULTILINE)


@pytest.mark.parametrize("path", LESSONS, ids=name)
def test_lesson_asks_at_least_three_questions(path: Path) -> None:
    asked = sum(len(re.findall(r"\bquiz\.\w+\(", source)) for source in cells(path, "code"))
    assert asked >= 3


@pytest.mark.parametrize("path", LESSONS, ids=name)
def test_lesson_has_a_viewer(path: Path) -> None:
    assert any(re.search(r"\bexplore\.\w+\(", source) for source in cells(path, "code"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=name)
def test_links_between_notebooks_lead_somewhere(path: Path) -> None:
    targets = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", "\n".join(cells(path, "markdown")))
    assert [t for t in targets if not (path.parent / t).exists()] == []
