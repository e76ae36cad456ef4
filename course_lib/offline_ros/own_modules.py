"""A ROS package's own Python modules, which its nodes import once catkin has built it."""

from __future__ import annotations

import re
from pathlib import Path

_CALLED = re.compile(r"^[^#\n]*\bcatkin_python_setup\s*\(", re.MULTILINE | re.IGNORECASE)


def own_modules(node: str | Path) -> Path | None:
    """Give the folder with the modules of the package that a file belongs to.

    catkin puts it on the path of every node if `CMakeLists.txt` calls `catkin_python_setup()` and
    there is a `setup.py`. That file is not run here: its folder is `src`, as ROS has it.

    Parameters
    ----------
    node : str or Path
        A file or folder within the package.

    Returns
    -------
    Path or None
        None when the package has no modules of its own.
    """
    path = Path(node).resolve()
    package = next(
        (each for each in (path, *path.parents) if (each / "package.xml").is_file()), path
    )
    build = package / "CMakeLists.txt"
    if not build.is_file() or not (package / "setup.py").is_file():
        return None
    called = _CALLED.search(build.read_text(encoding="utf-8", errors="replace"))
    return package / "src" if called else None
