def make(folder):
    (folder / "exercise_4_1.py").write_text("x = 1\n" * 500_000 + "def locate_mug(mug, scene):\n    return None\n")
