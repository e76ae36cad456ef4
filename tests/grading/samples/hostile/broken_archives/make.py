import io
import zipfile
import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    nbformat.write(made, path)
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("x.txt", "x" * 100_000)
    data = bytearray(whole.getvalue())
    (folder / "cut.zip").write_bytes(data[: len(data) // 2])
    (folder / "flipped.zip").write_bytes(bytes(data[:40]) + bytes(20) + bytes(data[60:]))
    locked = bytearray(data)
    at = locked.find(b"PK\x01\x02")
    locked[6] |= 1
    locked[at + 8] |= 1
    (folder / "locked.zip").write_bytes(locked)
    method = bytearray(data)
    method[8] = method[at + 10] = 99
    (folder / "method.zip").write_bytes(method)
    for name in ("x.tar", "x.tar.gz", "x.tgz", "x.tar.xz", "x.tar.bz2", "y.zip"):
        (folder / name).write_bytes(b"no archive at all" * 100)
