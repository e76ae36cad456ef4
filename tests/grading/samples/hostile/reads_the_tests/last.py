# %%
import os, sys

wanted = ("test_4_1", "heldout", "exercise_4_1.ipynb", "mug_1.png", "stand_ins")
found = []
for top in ["/", *sys.path, os.path.dirname(os.path.abspath(images.__file__)) + "/.."]:
    for folder, folders, files in os.walk(top):
        folders[:] = [f for f in folders if f not in ("proc", "sys", "share", "include", "lib", "site-packages")]
        if "site-packages" in folder and "course" not in folder or "/lib/python" in folder:
            continue
        found += [
            f"{folder}/{name}" for name in files + folders
            if any(word in name for word in wanted) and os.path.abspath(folder) != os.getcwd()
        ]
assert not found, f"GOT THROUGH: {found[:5]}"
