# %%
def locate_mug(mug, scene, match_count=100):
    kept = []
    while True:
        kept.append(bytearray(50_000_000))
