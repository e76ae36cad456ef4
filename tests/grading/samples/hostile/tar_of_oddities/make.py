import io
import tarfile
import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    with tarfile.open(folder / "work.tar.gz", "w:gz") as archive:
        for name, kind in (("hard", tarfile.LNKTYPE), ("soft", tarfile.SYMTYPE), ("pipe", tarfile.FIFOTYPE),
                           ("zero", tarfile.CHRTYPE), ("disk", tarfile.BLKTYPE)):
            entry = tarfile.TarInfo(name)
            entry.type, entry.linkname, entry.devmajor, entry.devminor = kind, "../../etc/passwd", 1, 5
            archive.addfile(entry)
        for name in ("../../../GOT_THROUGH", "/tmp/GOT_THROUGH", "a/../../GOT_THROUGH", "exercise_4_1.ipynb"):
            data = nbformat.writes(made).encode()
            entry = tarfile.TarInfo(name)
            entry.size, entry.mode = len(data), 0o6777
            archive.addfile(entry, io.BytesIO(data))
