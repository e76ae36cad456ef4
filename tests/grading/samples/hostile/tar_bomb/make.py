import bz2
import tarfile
import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    def write(archive, name, size, data=None):
        entry = tarfile.TarInfo(name)
        entry.size = size
        archive.write(entry.tobuf())
        if data is None:
            for _ in range(size >> 24):
                archive.write(bytes(1 << 24))
        else:
            archive.write(data + bytes(-len(data) % 512))

    with bz2.open(folder / "work.tar.bz2", "wb", 1) as archive:
        data = nbformat.writes(made).encode()
        write(archive, "exercise_4_1.ipynb", len(data), data)
        write(archive, "zeros", 1 << 29)
