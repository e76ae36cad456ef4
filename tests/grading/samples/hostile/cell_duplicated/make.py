import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    made.cells = [cell for cell in made.cells for _ in range(2)]
    with path.open("w") as file:
        json.dump(made, file)
