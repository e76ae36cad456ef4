import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    nbformat.write(made, path)
    for name in ("cv2", "numpy", "json", "zmq", "nbval", "pytest", "tornado", "PIL", "sitecustomize", "usercustomize",
                 "code", "cmd", "pdb", "bdb", "logging", "stack_data", "executing", "queue", "random"):
        (folder / f"{name}.py").write_text("raise SystemExit('GOT THROUGH')")
    for name in ("course_lib", "IPython", "ipykernel", "matplotlib"):
        (folder / name).mkdir()
        (folder / name / "__init__.py").write_text("raise SystemExit('GOT THROUGH')")
