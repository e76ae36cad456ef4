# %%
input("password: ")

# %%
import getpass
getpass.getpass()

# %%
breakpoint()

# %%
import pdb
pdb.set_trace()

# %%
import sys
sys.stdin.read()
