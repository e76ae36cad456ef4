# %%
import os, time

for _ in range(20):
    try:
        child = os.fork()
    except OSError:
        break
    if child == 0:
        os.setsid()
        while True:
            pass
time.sleep(60)
