"""An editor that did not ask: umlauts in Latin-1 where JSON should be UTF-8."""

import json
from pathlib import Path


def make(folder):
    (folder / "umlaute.py").unlink()
    script = Path(__file__).with_name("umlaute.py").read_text(encoding="utf-8")
    cells = [
        {"cell_type": "code", "source": cell, "metadata": {}, "outputs": [], "execution_count": 3}
        for cell in script.split("# %%\n")[1:]
    ]
    notebook = {"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 2}
    text = json.dumps(notebook, ensure_ascii=False)
    (folder / "Übung 4.1 (2).ipynb").write_bytes(text.encode("latin-1"))
