# %%
import os

os.makedirs("a/b/c", exist_ok=True)
open("a/b/c/d", "w").close()
for path in ("a/b/c", "a/b", "a", "."):
    os.chmod(path, 0)
os._exit(1)
