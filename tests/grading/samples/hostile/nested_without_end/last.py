# %%
_deep = []
for _ in range(100_000):
    _deep = [_deep]
_loop = {}
_loop["self"] = [_loop]

def locate_mug(mug, scene, match_count=100):
    return _deep

def load_images():
    return _loop
