# %%
for number in range(64):
    open(f"{number}", "wb").write(b"1" * 4_000_000)
import time
time.sleep(60)
