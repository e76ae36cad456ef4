"""What a Mac and a course platform make of a submission."""

import zipfile


def make(folder):
    notebook = folder / "exercise_4_1.ipynb"
    with zipfile.ZipFile(folder / "Homework final (3).zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write(notebook, "Unit 4/My Homework/EXERCISE_4_1.IPYNB")
        archive.writestr("__MACOSX/Unit 4/._EXERCISE_4_1.IPYNB", b"\x00\x05\x16\x07")
        archive.writestr("Unit 4/.DS_Store", b"\x00\x00\x00\x01Bud1")
        archive.writestr("Unit 4/My Homework/.ipynb_checkpoints/x-checkpoint.ipynb", "{}")
        archive.writestr("Unit 4/notes.txt", "for the tutorial on Monday")
    notebook.unlink()
