def make(folder):
    (folder / 'exercise_4_1.ipynb').touch()
