import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    made.cells[1].source += "\n" * 60_000
    made.cells.append(nbformat.v4.new_code_cell("x = 1" + "\n \t" * 60_000 + "\n%pwd"))
    nbformat.write(made, folder / "exercise_4_1.ipynb")
