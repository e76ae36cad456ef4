# %%
import os, re

found = []
try:
    seen = [name for name in os.listdir("/proc") if name.isdigit()]
except OSError:
    seen = []
for pid in [1, 2, os.getppid(), *seen]:
    if str(pid) == str(os.getpid()):
        continue
    for name in ("environ", "mem", "maps", "cwd", "root", "fd", "cmdline"):
        path = f"/proc/{pid}/{name}"
        try:
            if name in ("cwd", "root", "fd"):
                data = str(os.listdir(path)).encode()
            else:
                data = open(path, "rb").read(100_000)
        except OSError:
            continue
        if b"CAN" + b"ARY" in data or b"course_lib.grading.worker" in data or b"ipynb" in data:
            found.append(path)
assert not found, f"GOT THROUGH: {found}"
