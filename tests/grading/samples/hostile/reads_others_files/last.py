# %%
import os

found = []
for top in ("..", "../..", "/tmp", "/var/tmp", "/home", "/root", "/run", "/mnt", "/srv", "/work", "/dev/shm"):
    for folder, folders, files in os.walk(top):
        if os.path.abspath(folder).startswith(os.getcwd()):
            continue
        folders[:] = [f for f in folders if f not in (".pyenv", ".venv", "images", "course_lib")]
        found += [f"{folder}/{name}" for name in files if name.endswith((".ipynb", ".json", "seed", ".log", ".csv"))]
for path in ("/etc/shadow", "/etc/passwd", "/etc/hostname", "/root/.bash_history"):
    try:
        open(path).close()
        found.append(path)
    except OSError:
        pass
assert not found, f"GOT THROUGH: {found[:5]}"
