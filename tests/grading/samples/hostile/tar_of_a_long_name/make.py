import bz2
import tarfile
import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    entry = tarfile.TarInfo("x")
    entry.size, entry.type = 1 << 29, tarfile.GNUTYPE_LONGNAME
    with bz2.open(folder / "work.tar.bz2", "wb", 1) as archive:
        archive.write(entry.tobuf())
        for _ in range(32):
            archive.write(b"x" * (1 << 24))
    nbformat.write(made, path)
