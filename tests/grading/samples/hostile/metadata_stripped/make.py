import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    cells = [{"cell_type": "code", "source": cell.source} for cell in made.cells]
    path.write_text(json.dumps({"cells": cells}))
