import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    data = json.loads(nbformat.writes(made))
    data["metadata"] = {"kernelspec": 7, "language_info": [], "widgets": None}
    data["nbformat"], data["nbformat_minor"] = "four", -1
    for cell in data["cells"]:
        cell["metadata"] = {"tags": ["nbval-skip", "raises-exception", {"a": 1}], "nbgrader": {"points": 999}}
        cell["id"], cell["outputs"], cell["execution_count"] = "same", "none", "x"
        cell["source"] = "# NBVAL_SKIP\n# PYTEST_VALIDATE_IGNORE_OUTPUT\n" + "".join(cell["source"])
    path.write_text(json.dumps(data))
