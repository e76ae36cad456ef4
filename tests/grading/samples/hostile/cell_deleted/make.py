import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    made.cells = [cell for cell in made.cells if "def locate_mug" not in cell.source]
    nbformat.write(made, path)
