import stat
import zipfile
import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    with zipfile.ZipFile(folder / "work.zip", "w") as archive:
        for name, kind in (("pipe", stat.S_IFIFO), ("device", stat.S_IFBLK), ("link.ipynb", stat.S_IFLNK)):
            entry = zipfile.ZipInfo(name)
            entry.external_attr = (kind | 0o777) << 16
            archive.writestr(entry, "/etc/passwd")
        for name in ("../../../../tmp/GOT_THROUGH", "/tmp/GOT_THROUGH", "C:\\\\GOT_THROUGH", "..\\..\\GOT_THROUGH",
                     "a/../../GOT_THROUGH", "x" * 5000, "a/" * 200 + "b", "", ".", "..", "\x00name", "con\u202ename"):
            archive.writestr(zipfile.ZipInfo(name), "evil")
        archive.writestr("deeper/exercise_4_1.ipynb", nbformat.writes(made))
