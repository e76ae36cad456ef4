# %%
import threading, time

def busy():
    while True:
        time.sleep(0.001)

for _ in range(8):
    threading.Thread(target=busy, daemon=False).start()
