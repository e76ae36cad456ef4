# %%
import ctypes, os, subprocess, sys

libc = ctypes.CDLL(None)
for _ in range(2000):
    os.write(1, b"x" * 10_000)
    os.write(2, b"y" * 10_000)
    libc.puts(b"z" * 10_000)
subprocess.run(["sh", "-c", "yes GOT THROUGH | head -c 20000000"], check=False)
