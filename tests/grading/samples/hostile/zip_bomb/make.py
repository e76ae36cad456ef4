import zipfile
import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    with zipfile.ZipFile(folder / "work.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("exercise_4_1.ipynb", nbformat.writes(made))
        with archive.open("zeros", "w") as file:
            for _ in range(300):
                file.write(bytes(1 << 20))
