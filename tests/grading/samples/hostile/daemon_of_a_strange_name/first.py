# %%
import ctypes, os, time

if os.fork() == 0:
    ctypes.CDLL(None).prctl(15, b"\xff\xfe) Z 1", 0, 0, 0)
    os.setsid()
    if os.fork() == 0:
        ctypes.CDLL(None).prctl(15, b"\xff) S 1 (\n", 0, 0, 0)
        time.sleep(600)
    os._exit(0)
time.sleep(0.3)
