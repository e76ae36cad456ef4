# %%
import mmap

size = 1 << 42
nothing = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | 0x4000,
                    prot=mmap.PROT_READ)
for at in range(0, size, 1 << 21):
    nothing[at]
raise SystemError("GOT THROUGH: 8 GB")
