# %%
import mmap, time

kept = []
for _ in range(40):
    piece = mmap.mmap(-1, 100_000_000)
    for at in range(0, len(piece), 4096):
        piece[at] = 1
    kept.append(piece)
raise SystemError("GOT THROUGH: 4 GB")
