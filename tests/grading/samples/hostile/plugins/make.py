import json

import nbformat
from build import PLAIN, notebook


def make(folder):
    made = notebook(PLAIN.read_text())
    path = folder / "exercise_4_1.ipynb"
    nbformat.write(made, path)
    evil = "open('/tmp/GOT_THROUGH', 'w'); raise SystemExit('GOT THROUGH')"
    for name in ("conftest.py", "sitecustomize.py", "usercustomize.py", "nbval_plugin.py", "test_4_1_extra.py",
                 "noxfile.py", "setup.py", "ipython_config.py", "jupyter_config.py", "startup.py"):
        (folder / name).write_text(evil)
    (folder / "evil.pth").write_text("import os; " + evil)
    (folder / "pytest.ini").write_text("[pytest]\naddopts = -p conftest --exitfirst\npython_files = *.py\n")
    (folder / "pyproject.toml").write_text("[tool.pytest.ini_options]\naddopts = '-p evil'\n")
    (folder / "nbval.cfg").write_text("[regex]\nregex: .*\nreplace: x\n")
    (folder / "evil-1.dist-info").mkdir()
    (folder / "evil-1.dist-info" / "entry_points.txt").write_text("[pytest11]\nevil = conftest\n")
    (folder / "evil-1.dist-info" / "METADATA").write_text("Name: evil\nVersion: 1\n")
    (folder / ".ipython" / "profile_default" / "startup").mkdir(parents=True)
    (folder / ".ipython" / "profile_default" / "startup" / "0.py").write_text(evil)
