"""Takes a submission's files along to another machine as data, links and oddities included.

They arrive as they are, so that intake judges there what it would have judged here.
"""

from __future__ import annotations

import os
import stat
from typing import TYPE_CHECKING, Any

from course_lib.grading.intake.files import MOST_BYTES, MOST_FILE_BYTES

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

_MOST_ENTRIES = 20_000
_MOST_DEPTH = 40

Entry = dict[str, Any]


def pack(paths: Iterable[Path], most: int = MOST_BYTES) -> tuple[list[Entry], bytes]:
    """Read files and folders, without following a link.

    Parameters
    ----------
    paths : iterable of Path
        With different names.
    most : int, optional
        Bytes that are taken along. What is beyond arrives with its size only, which is enough for
        intake to leave it out.

    Returns
    -------
    entries : list of dict
        JSON's own types.
    content : bytes
        All files' bytes, one after the other.
    """
    packer = _Packer(most)
    for path in paths:
        packer.add(path, path.name, 0)
    return packer.entries, b"".join(packer.content)


class _Packer:
    def __init__(self, most: int) -> None:
        self.entries: list[Entry] = []
        self.content: list[bytes] = []
        self._left = most
        self._inodes: dict[tuple[int, int], str] = {}

    def add(self, path: Path, name: str, depth: int) -> None:
        if len(self.entries) >= _MOST_ENTRIES or depth > _MOST_DEPTH:
            return
        entry: Entry = {"name": name}
        try:
            status = path.lstat()
            entry["mode"] = stat.S_IMODE(status.st_mode) & 0o777
            if stat.S_ISDIR(status.st_mode):
                entry["kind"] = "folder"
                self.entries.append(entry)
                for child in sorted(path.iterdir()):
                    self.add(child, f"{name}/{child.name}", depth + 1)
                return
            if stat.S_ISLNK(status.st_mode):
                entry |= {"kind": "link", "target": str(path.readlink())}
            elif stat.S_ISREG(status.st_mode):
                entry |= self._file(path, name, status)
            else:
                entry["kind"] = "pipe"  # a device or socket, too, is nothing but odd
        except OSError:
            entry |= {"kind": "file", "mode": 0, "size": 0, "bytes": 0}
        self.entries.append(entry)

    def _file(self, path: Path, name: str, status: os.stat_result) -> Entry:
        if status.st_nlink > 1:
            first = self._inodes.setdefault((status.st_dev, status.st_ino), name)
            if first != name:
                return {"kind": "second name", "target": first}
        content = b""
        if status.st_size <= MOST_FILE_BYTES and status.st_size <= self._left:
            descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
            with os.fdopen(descriptor, "rb") as file:
                if stat.S_ISREG(os.fstat(descriptor).st_mode):
                    content = file.read(status.st_size)
        self._left -= len(content)
        self.content.append(content)
        linked = status.st_nlink > 1
        return {
            "kind": "file",
            "size": status.st_size,
            "bytes": len(content),
            "linked": linked,
        }


def unpack(entries: Sequence[Entry], content: bytes, folder: Path) -> list[Path]:
    """Write what `pack` read.

    Parameters
    ----------
    entries, content
        As `pack` gave them.
    folder : Path
        An empty folder.

    Returns
    -------
    list of Path
        The files and folders that were packed.

    Raises
    ------
    ValueError
        When a name leads out of the folder.
    """
    view, start = memoryview(content), 0
    modes: list[tuple[Path, int]] = []
    for entry in entries:
        parts = entry["name"].split("/")
        if not all(part and part not in {".", ".."} for part in parts):
            raise ValueError("a name leads out of its folder")
        path = folder / entry["name"]
        kind = entry["kind"]
        if kind == "folder":
            path.mkdir()
        elif kind == "link":
            path.symlink_to(entry["target"])
            continue
        elif kind == "second name":
            os.link(folder / entry["target"], path, follow_symlinks=False)
            continue
        elif kind == "pipe":
            os.mkfifo(path)
        else:
            with path.open("xb") as file:
                file.write(view[start : start + entry["bytes"]])
                file.truncate(entry["size"])
            start += entry["bytes"]
        modes.append((path, entry["mode"]))
    _link_outside(entries, folder)
    for path, mode in reversed(modes):  # a folder's own last: it may forbid to enter
        path.chmod(mode)
    return [folder / entry["name"] for entry in entries if "/" not in entry["name"]]


def _link_outside(entries: Sequence[Entry], folder: Path) -> None:
    """Give a file whose second name lay elsewhere such a name again."""
    for number, entry in enumerate(entries):
        if entry.get("linked"):
            elsewhere = folder.with_name(f"{folder.name}.links")
            elsewhere.mkdir(exist_ok=True)
            os.link(folder / entry["name"], elsewhere / str(number), follow_symlinks=False)
