import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    nbformat.write(made, folder / "mine.ipynb")
    path.mkdir()
    (path / "x").touch()
    (folder / "unit4").write_text("no folder")
    (folder / "package").mkdir()
    (folder / "package" / "package.xml").write_text("<package/>")
