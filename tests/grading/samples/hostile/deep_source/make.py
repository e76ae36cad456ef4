import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    made.cells[3].source = "def find_keypoints(image):\n    raise NotImplementedError" + ".x" * 400 + "\n" + made.cells[2].source
    for source in ("x = " + "(" * 5000 + ")" * 5000, "x = " + "-" * 20_000 + "1", "x" + ".y" * 2_000,
                   "def locate_mug():\n    raise x" + ".y" * 700, "x = " + "[" * 150 + "]" * 150, "\x00", "x = 1\x00",
                   "if 1:\n" + "".join(" " * n + "if 1:\n" for n in range(1, 120)) + " " * 120 + "pass"):
        made.cells.insert(0, nbformat.v4.new_code_cell(source))
    nbformat.write(made, path)
