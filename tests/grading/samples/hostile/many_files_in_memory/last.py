# %%
import os

os.makedirs("/tmp/many" if os.access("/tmp", os.W_OK) else os.path.expanduser("~/many"))
os.chdir("/tmp/many" if os.path.isdir("/tmp/many") else os.path.expanduser("~/many"))
for number in range(1_000_000):
    os.close(os.open(f"{number:0100}", os.O_CREAT | os.O_WRONLY))
raise SystemError("GOT THROUGH")
