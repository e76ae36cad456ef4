# %%
import ctypes, os, platform, time

libc = ctypes.CDLL(None, use_errno=True)
CLONE = {"x86_64": 56, "aarch64": 220}[platform.machine()]
CLONE_PARENT, SIGCHLD = 0x8000, 17
made = []
for _ in range(6):
    pid = libc.syscall(CLONE, CLONE_PARENT | SIGCHLD, 0, 0, 0, 0)
    if pid == 0:
        try:
            held = bytearray(200 * 2**20)
            held[::4096] = b"x" * (len(held) // 4096)
            time.sleep(15)
        finally:
            os._exit(0)
    made.append(pid)
if max(made) > 0:
    time.sleep(6)
    held = sum(os.path.exists(f"/proc/{pid}") for pid in made)
    raise RuntimeError(f"GOT THROUGH: nobody counts {held} children that are given to somebody else")
