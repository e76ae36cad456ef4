import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    path.write_text("[" * 1_000_000 + "]" * 1_000_000)
    for number, odd in enumerate([1, None, "x", [], {"cells": 3}, {"cells": [1, {}, {"source": {"a": 1}}]},
                                  {"worksheets": [None, {"cells": 1}]}, {"cells": [{"cell_type": [], "source": [1]}]}]):
        (folder / f"odd {number}.ipynb").write_text(json.dumps(odd))
    (folder / "exercise.ipynb").write_text('{"cells": ' + "1" * 100_000 + "}")
