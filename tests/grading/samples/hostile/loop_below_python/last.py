# %%
import collections, itertools

def locate_mug(mug, scene, match_count=100):
    collections.deque(itertools.repeat(0), maxlen=0)
