"""Delete a cell, as happens when one means to leave it."""

import nbformat


def make(folder):
    path = folder / "exercise_4_1.ipynb"
    notebook = nbformat.read(path, as_version=4)
    notebook.cells = [cell for cell in notebook.cells if not cell.source.startswith("def match_keypoints")]
    nbformat.write(notebook, path)
