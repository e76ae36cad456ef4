# %%
import itertools

_odd = itertools.cycle([
    "corners", b"corners", {}, {"a": {1: 2}}, [], (), [[]], [[], []], np.zeros((0, 2)), np.zeros((4, 2, 0)),
    np.zeros((1,) * 8), np.float16(3), np.zeros((4, 2), bool), np.zeros((4, 2), np.uint64) - 1,
    [[1, 2]] * 3 + [[1]], [["a", "b"]] * 4, [[None] * 2] * 4, True, 2**80, -1, 1j, object, type, print,
    np.array([["1", "2"]] * 4), np.zeros((4, 2), complex), [np.zeros((4, 2))] * 4, np.zeros((100000, 2)),
    ..., NotImplemented, range(8), {1, 2}, iter([]), np.ma.masked_array([[1, 2]] * 4, mask=True),
])

def locate_mug(mug, scene, match_count=100):
    return next(_odd)

def find_keypoints(image):
    return next(_odd)

def match_keypoints(*args):
    return next(_odd)

def load_images():
    return next(_odd), next(_odd)
