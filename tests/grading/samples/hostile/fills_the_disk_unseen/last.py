# %%
import os, time

kept = []
for number in range(64):
    file = open("unseen", "w+b")
    os.unlink("unseen")
    file.write(b"1" * 4_000_000)
    file.flush()
    kept.append(file)
time.sleep(60)
raise SystemError("GOT THROUGH")
