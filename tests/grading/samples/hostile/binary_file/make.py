import random


def make(folder):
    (folder / 'exercise_4_1.ipynb').write_bytes(random.Random(1).randbytes(100_000))
