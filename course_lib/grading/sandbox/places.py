"""What a submission can see: the interpreter, the course, its own folder. Nothing else."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import course_lib

COURSE = Path(course_lib.__file__).resolve().parent
HOME = "/home/student"
WORK = f"{HOME}/work"
# The channels whose sockets are handed over, in this order. The heartbeat's goes nowhere.
CHANNELS = ("shell", "iopub", "stdin", "control")
_SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32")
_SETTINGS = ("/etc/ld.so.cache", "/etc/alternatives", "/etc/fonts", "/etc/localtime", "/etc/ros")
# The grader, and what makes its held-out inputs and knows their truth.
_HIDDEN = ("grading", "scenes", "scenes.py")
_HIDDEN_PICTURES = "heldout"
_PICTURES = "images"
_EXERCISE_PICTURES = ("ROS.png", "ROS2.png", "flight.bag")
_PACKAGES = {"site-packages", "dist-packages"}


def readable() -> list[Path]:
    """List the folders of the system and of the interpreter, none within another.

    The course may itself lie in one of them, as ``/usr/src/course`` does; then they are listed
    without the folder that holds its tests, its solutions and its held-out pictures.
    """
    found: list[Path] = []
    places = [*_SYSTEM, *_SETTINGS, sys.base_prefix, sys.prefix, *_packages()]
    for place in sorted({Path(p) for p in places if Path(p).exists()}, key=lambda p: len(p.parts)):
        if not any(place.is_relative_to(known) for known in found):
            found.append(place)
    secret = COURSE if COURSE.parent.name in _PACKAGES else COURSE.parent
    return [part for place in found for part in _without(place, secret)]


def _without(place: Path, secret: Path) -> list[Path]:
    """List what is in a folder, as whole as possible, but for what is secret."""
    if not secret.is_relative_to(place.resolve()):
        return [place]
    if place.resolve() == secret or place.is_symlink():
        return []
    return [part for child in sorted(place.iterdir()) for part in _without(child, secret)]


def seen_by_students(path: Path) -> Path | None:
    """Tell which of the places that students' code can read a path lies in, if any."""
    return next((p for p in readable() if path.resolve().is_relative_to(p.resolve())), None)


def _packages() -> list[str]:
    """List the folders of installed packages; some may lie outside the interpreter's own."""
    return [path for path in sys.path if Path(path).name in _PACKAGES]


def course() -> list[Path]:
    """List the files and folders of the course that a student may read."""
    parts = [path for path in sorted(COURSE.iterdir()) if path.name not in _HIDDEN]
    return parts + [path for path in sorted(pictures().iterdir()) if path.name != _HIDDEN_PICTURES]


def pictures() -> Path:
    """Give the folder of the course's pictures."""
    return COURSE.parent / _PICTURES


def lay_out_pictures(folder: Path) -> None:
    """
    Put the course's pictures where ``cv2.imread`` looks for them, beside and in a working folder.

    A student who wrote ``../images/ROS.png``, ``images/ROS.png`` or kept a copy beside the notebook
    has made no mistake. What was handed in stays as it is.

    Parameters
    ----------
    folder : Path
        The working folder, not yet handed over; pictures go into its parent too.
    """
    links = [folder.parent / _PICTURES, folder / _PICTURES]
    links += [folder / name for name in _EXERCISE_PICTURES]
    for link in links:
        if not os.path.lexists(link):
            link.symlink_to(pictures() if link.name == _PICTURES else pictures() / link.name)


def lay_out_course(folder: Path) -> None:
    """
    Link the course's parts that a student may read, so that they can be listed.

    Landlock opens single files and folders, and not the folder that they lie in; an interpreter
    that a student starts, such as a node's, finds no module where it cannot list.

    Parameters
    ----------
    folder : Path
        Goes to ``PYTHONPATH``; made here.
    """
    package = folder / COURSE.name
    package.mkdir(parents=True)
    for part in course():
        if part.parent == COURSE:
            (package / part.name).symlink_to(part)


def environment(home: str) -> dict[str, str]:
    """Give the environment of a student's process.

    Parameters
    ----------
    home : str
        Its home folder.

    Returns
    -------
    dict of str to str
    """
    return {
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), "/usr/bin", "/bin"]),
        "HOME": home,
        "USER": "student",
        "LANG": "C.UTF-8",
        "PYTHONPATH": os.pathsep.join([str(COURSE.parent), *_packages()]),
        "PYTHONHASHSEED": "0",
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONNOUSERSITE": "1",
        "MPLBACKEND": "module://matplotlib_inline.backend_inline",
        "IPYTHONDIR": f"{home}/.ipython",
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
    }
