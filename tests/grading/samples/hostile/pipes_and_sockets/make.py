import contextlib
import os
import socket
import stat
import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    nbformat.write(made, path)
    os.mkfifo(folder / "exercise_4_2.ipynb")
    os.mkfifo(folder / "pipe.zip")
    with contextlib.closing(socket.socket(socket.AF_UNIX)) as one:
        here = os.getcwd()
        os.chdir(folder)
        one.bind("socket.ipynb")
        os.chdir(here)
    with contextlib.suppress(OSError):
        os.mknod(folder / "zero.ipynb", 0o666 | stat.S_IFCHR, os.makedev(1, 5))
