# %%
import ctypes

ctypes.CDLL(None).prctl(15, b"\xff\xfe) Z 1", 0, 0, 0)
