import nbformat
from build import notebook

LAUGHS = "".join(f'<!ENTITY l{n} "{f"&l{n - 1};" * 10}">' for n in range(1, 30))


def make(folder):
    nbformat.write(notebook("# %%\ndef crop_waterhole(frame):\n    return frame"), folder / "exercise_4_2.ipynb")
    for name in ("package.xml", "launch/exercise4_2_2.launch"):
        path = folder / "unit4" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY l0 "lol"><!ENTITY f SYSTEM "file:///etc/passwd">{LAUGHS}]><package>&l29;&f;</package>')
