import os
import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    nbformat.write(made, path)
    (folder / "passwd.ipynb").symlink_to("/etc/passwd")
    (folder / "exercise_4_2.ipynb").symlink_to("../neighbour/exercise_4_1.ipynb")
    (folder / "loop").symlink_to("loop")
    (folder / "up").symlink_to("..")
    (folder / "root").symlink_to("/")
    (folder / "a").mkdir()
    (folder / "a" / "b").symlink_to("../a")
    os.link("/etc/hostname" if os.stat("/etc/hostname").st_dev == folder.stat().st_dev else __file__, folder / "hard.ipynb")
