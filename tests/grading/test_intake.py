"""Which notebook is taken for which exercise."""

from __future__ import annotations

import json
import zipfile

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook

from course_lib.grading.submission import Source, stage

BODIES = {
    "4.1": ("load_images", "find_keypoints", "match_keypoints", "locate_mug"),
    "4.2": ("find_keypoints", "crop_waterhole", "locate_waterhole", "best_match_count"),
}


def handed_in(folder, **notebooks):
    """Stage notebooks that define the functions of some exercises."""
    folder.mkdir()
    for name, exercises in notebooks.items():
        functions = [function for each in exercises for function in BODIES[each]]
        cells = [new_code_cell(f"def {function}(*given):\n    return 1") for function in functions]
        nbformat.write(new_notebook(cells=cells), folder / f"{name}.ipynb")
    return stage(Source("student", (folder,)), folder.parent / "staged")


def test_a_notebook_named_for_one_exercise_is_not_taken_for_the_other(tmp_path):
    """Both have a function find_keypoints."""
    found = handed_in(tmp_path / "in", exercise_4_2=["4.2"])
    assert set(found.notebooks) == {"4.2"}
    assert "no notebook of Exercise 4.1" in found.problems["4.1"]
    assert found.notes == ()


def test_a_broken_file_is_told_of_where_it_belongs(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "exercise_4_1.ipynb").write_text('{"cells": [')
    (tmp_path / "in" / "homework.ipynb").write_text("")
    found = stage(Source("student", (tmp_path / "in",)), tmp_path / "staged")
    assert "exercise_4_1.ipynb ends in the middle" in found.problems["4.1"]
    assert "exercise_4_1.ipynb" not in found.problems["4.2"]
    assert all("homework.ipynb is empty" in problem for problem in found.problems.values())
    assert "exercise_4_1.ipynb could not be read, and nothing else is Exercise 4.1" in found.events


@pytest.mark.parametrize(
    "encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "cp1252"]
)
def test_any_usual_encoding_is_read(tmp_path, encoding):
    (tmp_path / "in").mkdir()
    cell = new_code_cell("def locate_mug(template, scene, match_count):\n    return 'Tasse grün'")
    text = json.dumps(new_notebook(cells=[cell]), ensure_ascii=False)
    (tmp_path / "in" / "exercise_4_1.ipynb").write_bytes(text.encode(encoding))
    found = stage(Source("student", (tmp_path / "in",)), tmp_path / "staged")
    assert "Tasse grün" in found.notebooks["4.1"].read_text("utf-8")


@pytest.mark.parametrize("name", ["my_homework", "unit_4_1_and_4_2", "exercise_4_1"])
def test_both_exercises_may_stand_in_one_notebook(tmp_path, name):
    found = handed_in(tmp_path / "in", **{name: ["4.1", "4.2"]})
    assert set(found.notebooks) == {"4.1", "4.2"}
    assert f"{name}.ipynb was taken as your notebook of Exercise 4.2." in found.notes


def test_exchanged_names_are_seen_through(tmp_path):
    found = handed_in(tmp_path / "in", exercise_4_1=["4.2"], exercise_4_2=["4.1"])
    assert "locate_mug" in found.notebooks["4.1"].read_text()
    assert "locate_waterhole" in found.notebooks["4.2"].read_text()


def test_a_package_whose_files_lie_beside_the_notebook_is_taken(tmp_path):
    """As from a zip of the folder's content, in a folder with the notebook."""
    (tmp_path / "in").mkdir()
    cell = new_code_cell("def crop_waterhole(frame):\n    return frame")
    nbformat.write(new_notebook(cells=[cell]), tmp_path / "in" / "exercise_4_2.ipynb")
    with zipfile.ZipFile(tmp_path / "in" / "unit4.zip", "w") as archive:
        archive.writestr("package.xml", "<package/>")
        archive.writestr("src/exercise4_2_1.py", "#!/usr/bin/env python3\n")
    found = stage(Source("student", (tmp_path / "in",)), tmp_path / "staged")
    assert (found.folder / "unit4" / "package.xml").is_file()
    assert (found.folder / "unit4" / "src" / "exercise4_2_1.py").is_file()
    assert any("beside the notebook" in note for note in found.notes)
