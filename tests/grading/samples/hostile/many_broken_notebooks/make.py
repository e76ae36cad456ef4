def make(folder):
    for number in range(400):
        (folder / f"{number:03d} {'n' * 80}.ipynb").write_text("{")
