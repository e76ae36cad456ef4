import nbformat
from build import notebook

NODE = """
#!/usr/bin/env python3
import signal
for number in range(1, 65):
    try:
        signal.signal(number, signal.SIG_IGN)
    except (OSError, ValueError):
        pass
while True:
    pass
"""


def make(folder):
    nbformat.write(notebook("# %%\ndef crop_waterhole(frame):\n    return frame"), folder / "exercise_4_2.ipynb")
    (folder / "unit4" / "src").mkdir(parents=True)
    (folder / "unit4" / "package.xml").write_text("<package/>")
    node = folder / "unit4" / "src" / "exercise4_2_2.py"
    node.write_text(NODE)
    node.chmod(0o755)
