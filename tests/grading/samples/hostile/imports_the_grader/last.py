# %%
import importlib, sys

got = []
for name in ("session", "seeds", "rubric", "runner", "seed_file", "student", "report", "geometry"):
    try:
        importlib.import_module(f"course_lib.grading.{name}")
        got.append(name)
    except ImportError:
        pass
for name in ("course_lib.scenes", "tests.hidden.test_4_1_locate", "demo_class"):
    try:
        importlib.import_module(name)
        got.append(name)
    except ImportError:
        pass
for name, module in list(sys.modules.items()):
    if "grading" in name and getattr(module, "__file__", None):
        try:
            got.append(open(module.__file__).read()[:10])
        except OSError:
            pass
assert not got, f"GOT THROUGH: {got}"
