# %%
import os

for number in range(60_000):
    os.mkdir(f"{number}")
import time
time.sleep(5)
