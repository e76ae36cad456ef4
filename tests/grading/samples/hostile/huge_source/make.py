import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    made.cells[0].source += "\nx = 1" * 500_000
    nbformat.write(made, path)
