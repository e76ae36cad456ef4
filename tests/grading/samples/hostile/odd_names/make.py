import os
import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    nbformat.write(made, folder / "Exercise 4_1 \u202egpj.ipynb")
    for name in ("<script>alert(1)<\u2215script>.ipynb", "'; DROP TABLE grades; --.txt", "-rf", "$(touch GOT_THROUGH)", "a\nb.ipynb",
                 "\x1b[31mred\x1b[0m.ipynb", "\u0430\u0440\u0430\u0442.py", "NUL", "..\u2024.txt", "\U000e0041", "e\u0301.txt", "\u00e9.txt", "x" * 200):
        (folder / name).write_text("{}")
    (folder / os.fsdecode(b"\xff\xfe.ipynb")).write_text("{}")
