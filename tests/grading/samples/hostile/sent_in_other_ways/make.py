import json
from pathlib import Path


def make(folder: Path) -> None:
    (folder / "exercise_4_1.ipynb.txt").write_text(json.dumps({"cells": []}))
    (folder / "work.7z").write_bytes(b"7z\xbc\xaf\x27\x1c" + bytes(100))
    (folder / "exercise_4_1.ipynb").symlink_to("/etc/passwd")
    (folder / ".ipynb_checkpoints").mkdir()
    (folder / ".ipynb_checkpoints" / "exercise_4_1-checkpoint.ipynb").write_text("{}")
