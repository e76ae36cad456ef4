# %%
class Posing:
    __class__ = np.ndarray
    dtype, ndim, shape, nbytes = np.dtype("uint8"), 3, (600, 400, 3), 720_000
    def __array__(self, *a, **k):
        raise SystemExit
    def __len__(self):
        return -1

class Lying(np.ndarray):
    shape = property(lambda self: (2**40, 2**40, 3))
    nbytes = property(lambda self: -1)
    dtype = property(lambda self: np.dtype("uint8"))
    def tobytes(self, *a):
        return b"x" * 10
    def __eq__(self, other):
        return True

class Text(str):
    def encode(self, *a, **k):
        raise KeyboardInterrupt

def load_images():
    return Posing(), np.zeros((400, 600, 3), np.uint8).view(Lying)

def locate_mug(mug, scene, match_count=100):
    class Number(float):
        def __repr__(self):
            return "1e5<script>"
        def __float__(self):
            return np.nan
    return [[Number("inf"), Number("nan")], [Text("x"), True]]
