# %%
import gc, os, re

needle = bytes(c ^ 32 for c in b"canary")
hits = []
with open("/proc/self/maps") as maps, open("/proc/self/mem", "rb", 0) as memory:
    for line in maps:
        start, end = (int(part, 16) for part in line.split()[0].split("-"))
        if "rw" in line.split()[1] and end - start < 300_000_000:
            try:
                memory.seek(start)
                data = memory.read(end - start)
            except (OSError, ValueError, OverflowError):
                continue
            hits += re.findall(needle + rb"-[a-z]{4,}", data)
            del data
environ = str(dict(os.environ))
assert not hits and needle.decode() not in environ, f"GOT THROUGH: {hits[:3]}"
