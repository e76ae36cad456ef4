# %%
import os

for number in range(8_000):
    os.mkdir(f"{number}")
import time
time.sleep(60)
