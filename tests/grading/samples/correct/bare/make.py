"""What some tools leave of a notebook: cells, and nothing that nbformat would call valid."""

import json


def make(folder):
    path = folder / "exercise_4_1.ipynb"
    read = json.loads(path.read_text(encoding="utf-8"))
    cells = [
        {"cell_type": cell["cell_type"], "source": "".join(cell["source"]).splitlines(True)}
        for cell in read["cells"]
    ]
    path.write_text(json.dumps({"cells": cells}), encoding="utf-8-sig")
