# %%
import itertools

_odd = itertools.cycle([np.nan, np.inf, -np.inf, 1e308, -1e308, 1e30, 5e-324])

def locate_mug(mug, scene, match_count=100):
    return np.full((4, 2), next(_odd)) * [[1, 1], [1, -1], [-1, 1], [2, 3]]
