# %%
import ctypes, os, resource

libc = ctypes.CDLL(None, use_errno=True)
got = []
others = [os.getppid(), 1, *range(2, 40000)]
for pid in others:
    if pid in (0, os.getpid()):
        continue
    try:
        resource.prlimit(pid, resource.RLIMIT_NOFILE, (3, 3))
        got.append(("prlimit", pid))
    except (OSError, ValueError):
        pass
    for what in (os.PRIO_PROCESS, os.PRIO_PGRP):
        try:
            os.setpriority(what, pid, 19)
            got.append(("priority", pid))
        except OSError:
            pass
    try:
        os.sched_setaffinity(pid, {0})
        got.append(("affinity", pid))
    except OSError:
        pass
    if libc.ptrace(16, pid, 0, 0) == 0:
        got.append(("ptrace", pid))
try:
    os.setpriority(os.PRIO_USER, 0, 19)
    got.append("user's priority")
except OSError:
    pass
inside = [each for each in got if each[1] > 10] if os.getpid() < 20 else got
assert not inside, f"GOT THROUGH: {inside[:5]}"
