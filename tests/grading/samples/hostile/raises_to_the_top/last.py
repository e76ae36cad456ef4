# %%
class Evil(BaseException):
    def __str__(self):
        raise SystemExit(0)
    __repr__ = __str__

Evil.__name__ = Evil.__qualname__ = "<script>alert(1)</script>" * 1000
raise Evil

# %%
raise SystemExit("all tests passed")

# %%
raise KeyboardInterrupt

# %%
_locate = locate_mug

def locate_mug(*args):
    if args[0].mean() > 0:
        raise Evil
