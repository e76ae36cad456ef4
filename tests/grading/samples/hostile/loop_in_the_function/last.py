# %%
def locate_mug(mug, scene, match_count=100):
    while True:
        pass
