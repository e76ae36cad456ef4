import zipfile
import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    stub = "def locate_mug(mug, scene):\n    raise NotImplementedError"
    nbformat.write(notebook("# %%\n" + stub), path)
    (folder / "final").mkdir()
    with zipfile.ZipFile(folder / "final" / "last version.zip", "w") as archive:
        archive.writestr("really/Exercise 4_1 (3).ipynb", nbformat.writes(made))
