"""Which notebook is taken for which exercise."""

from __future__ import annotations

import errno
import json
import shutil
import zipfile
from pathlib import Path

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook

from course_lib.grading.intake.files import Copier
from course_lib.grading.submission import Source, find_submissions, passed_over, stage

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


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("exercise_4_1.ipynb.txt", "It holds exercise_4_1.ipynb.txt: a notebook's name ends with"),
        ("work.7z", "Of archives, .zip and .tar.gz are opened"),
        (".ipynb_checkpoints", "It holds no files"),
    ],
)
def test_what_is_no_notebook_is_named(tmp_path, name, said):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / name).write_text("x")
    found = stage(Source("student", (tmp_path / "in",)), tmp_path / "staged")
    assert said in found.problems["4.1"]


def test_a_link_is_named_to_the_student(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "exercise_4_1.ipynb").symlink_to("/etc/passwd")
    found = stage(Source("student", (tmp_path / "in",)), tmp_path / "staged")
    assert "exercise_4_1.ipynb is a symbolic link and was left out." in found.problems["4.1"]
    assert "symbolic link" not in found.problems["4.2"]


def test_who_sends_what_nobody_opens_is_among_the_students(tmp_path):
    for name in ("ada.7z", "bob.rar", "eve_exercise_4_1.ipynb.txt", "roster.csv", "README.md"):
        (tmp_path / name).write_text("x")
    assert [source.student for source in find_submissions(tmp_path)] == ["ada", "bob", "eve"]
    assert passed_over(tmp_path) == ["README.md", "roster.csv"]


def test_a_number_without_end_is_not_called_deep(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "exercise_4_1.ipynb").write_text('{"nbformat": ' + "9" * 100_000 + "}")
    found = stage(Source("student", (tmp_path / "in",)), tmp_path / "staged")
    assert "it holds a number without end" in found.problems["4.1"]


@pytest.mark.parametrize("packed", [False, True])
def test_thousands_of_files_beside_it_hide_no_exercise(tmp_path, packed):
    """As an environment of Python's, or a flight's frames, which come earlier in the alphabet."""
    (tmp_path / "ada" / "env").mkdir(parents=True)
    for number in range(1200):
        (tmp_path / "ada" / "env" / f"{number}.py").write_text("x = 1")
    cell = new_code_cell("def crop_waterhole(frame):\n    return frame")
    nbformat.write(new_notebook(cells=[cell]), tmp_path / "ada" / "exercise_4_2.ipynb")
    (tmp_path / "ada" / "unit4").mkdir()
    (tmp_path / "ada" / "unit4" / "package.xml").write_text("<package/>")
    source = tmp_path / "ada"
    if packed:
        source = Path(shutil.make_archive(str(tmp_path / "bob"), "zip", tmp_path, "ada"))
    found = stage(Source("student", (source,)), tmp_path / "staged")
    assert "4.2" in found.notebooks
    assert (found.folder / "unit4" / "package.xml").is_file()
    assert "Your submission has more than 1000 files; the rest was left out." in found.notes


def test_a_script_that_is_far_too_long_is_named(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "exercise_4_1.py").write_text("x = 1\n" * 400_000)
    found = stage(Source("student", (tmp_path / "in",)), tmp_path / "staged")
    assert "exercise_4_1.py holds more than two million characters" in found.problems["4.1"]


def test_a_full_disk_is_not_the_files_fault(tmp_path, monkeypatch):
    """A file left out for it would cost its student the points, and no later run would look."""
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "exercise_4_1.ipynb").write_text("{}")

    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Copier, "_write", full)
    with pytest.raises(OSError, match="No space left"):
        stage(Source("student", (tmp_path / "in",)), tmp_path / "staged")
