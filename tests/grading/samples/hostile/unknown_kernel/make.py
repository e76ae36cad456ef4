import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    made.metadata["kernelspec"] = {"name": "../../bin/sh -c id", "display_name": "x", "argv": ["sh"]}
    made.metadata["language_info"] = {"name": "brainfuck"}
    nbformat.write(made, path)
