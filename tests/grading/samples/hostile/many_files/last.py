# %%
for number in range(60_000):
    open(f"{number:0200}", "w").close()
import time
time.sleep(60)
