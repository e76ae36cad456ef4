# %%
kernel = get_ipython().kernel
kernel.do_shutdown(True)
get_ipython().ask_exit()

# %%
exit()

# %%
quit()

# %%
import atexit, sys

atexit._run_exitfuncs()
sys.exit(0)
