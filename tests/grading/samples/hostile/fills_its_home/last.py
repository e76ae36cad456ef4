# %%
import os, tempfile, time

for folder in (os.path.expanduser("~"), tempfile.gettempdir()):
    for number in range(100):
        try:
            open(f"{folder}/fill{number}", "wb").write(b"1" * 4_000_000)
        except OSError:
            break
time.sleep(60)
raise SystemError("GOT THROUGH")
