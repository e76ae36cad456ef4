"""The solution in nbformat 3, written by hand: worksheets, `input`, heading cells."""

import json


def make(folder):
    path = folder / "exercise_4_1.ipynb"
    new = json.loads(path.read_text(encoding="utf-8"))
    cells = [{"cell_type": "heading", "level": 1, "metadata": {}, "source": "Exercise 4.1"}]
    for cell in new["cells"]:
        lines = "".join(cell["source"]).splitlines(keepends=True)
        if cell["cell_type"] == "code":
            cells.append(
                {
                    "cell_type": "code",
                    "collapsed": False,
                    "input": lines,
                    "language": "python",
                    "metadata": {},
                    "outputs": [{"output_type": "pyout", "prompt_number": 7, "text": ["42"]}],
                    "prompt_number": 7,
                }
            )
        else:
            cells.append({"cell_type": "markdown", "metadata": {}, "source": lines})
    old = {
        "metadata": {"name": "Exercise 4.1", "signature": "sha256:0"},
        "nbformat": 3,
        "nbformat_minor": 0,
        "worksheets": [{"cells": cells[:20], "metadata": {}}, {"cells": cells[20:]}],
    }
    path.write_text(json.dumps(old), encoding="utf-8")
