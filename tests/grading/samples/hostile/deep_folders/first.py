# %%
import os

home = os.getcwd()
for top in (home, os.path.expanduser("~"), os.environ.get("TMPDIR", "/tmp")):
    try:
        os.chdir(top)
        for _ in range(3000):
            os.mkdir("deep")
            os.chdir("deep")
    except OSError:
        pass
os.chdir(home)
