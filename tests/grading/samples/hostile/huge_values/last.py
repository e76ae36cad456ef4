# %%
def locate_mug(mug, scene, match_count=100):
    return np.zeros((2**30,), np.uint8)

def load_images():
    return [0] * 3_000_000, "x" * 30_000_000
