# %%
def locate_mug(mug, scene, match_count=100):
    return 3 ** (3**25)
