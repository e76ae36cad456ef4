# %%
import ctypes, os
from multiprocessing import shared_memory

libc = ctypes.CDLL(None, use_errno=True)
libc.shmget(0x1234, 1 << 20, 0o1666)
libc.msgget(0x1234, 0o1666)
libc.semget(0x1234, 5, 0o1666)
libc.syscall(248, b"user", b"name", b"data", 4, -4)
for name in ("/dev/shm/left", "/tmp/left", "/var/tmp/left", "/dev/mqueue/left"):
    try:
        open(name, "w").write("left")
    except OSError:
        pass
try:
    kept = shared_memory.SharedMemory("left-too", create=True, size=1 << 20)
except OSError:
    pass
try:
    ctypes.CDLL("librt.so.1").mq_open(b"/left", 0o102, 0o666, None)
except (OSError, AttributeError):
    pass
