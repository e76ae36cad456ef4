"""MuJoCo, imported so that it draws without a display: through EGL, else through OSMesa."""

from __future__ import annotations

import ctypes.util
import importlib
import os
import subprocess
import sys
from functools import cache
from typing import Any

PACKAGES = "libegl1 libopengl0 libgl1-mesa-dri"
PROBE = "import sys; from mujoco.{0} import GLContext; GLContext(16, 16).make_current()"


class RendererError(RuntimeError):
    """The simulated drone cannot see: no MuJoCo, or nothing to draw with. Says what to install."""


def _libraries() -> list[str]:
    wanted = os.environ.get("MUJOCO_GL", "").strip().lower()
    if wanted in {"egl", "osmesa"}:
        return [wanted]
    return [
        name
        for name, library in (("egl", "EGL"), ("osmesa", "OSMesa"))
        if ctypes.util.find_library(library)
    ]


def _works(name: str) -> bool:
    """Try a library in another process: a second one cannot be tried in the same."""
    environment = os.environ | {"MUJOCO_GL": "disable"}
    environment.pop("PYOPENGL_PLATFORM", None)
    command = [sys.executable, "-c", PROBE.format(name)]
    try:
        tried = subprocess.run(  # noqa: S603 (our own line)
            command, env=environment, capture_output=True, timeout=60, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return tried.returncode == 0


def _missing(found: list[str]) -> str:
    if not found:
        return f"no EGL library is installed; on Debian: apt install {PACKAGES}"
    return (
        f"{' and '.join(found)} cannot draw here; on Debian: apt install {PACKAGES} "
        "(Mesa draws without a graphics card)"
    )


@cache
def load() -> tuple[Any, Any]:
    """Import MuJoCo and choose what it draws with.

    Returns
    -------
    mujoco : module
    context : type
        Makes an OpenGL context of (width, height).

    Raises
    ------
    RendererError
        MuJoCo is not installed, or there is nothing to draw with; the message says what to do.
    """
    # MuJoCo's own choice is a window on a display, at import.
    os.environ.setdefault("MUJOCO_GL", "disable")
    try:
        mujoco = importlib.import_module("mujoco")
    except ImportError as error:
        raise RendererError(f"MuJoCo is missing ({error}): pip install mujoco") from error
    found = _libraries()
    # Where there is no choice there is nothing to try: `Eye` sees whether it works.
    tried = [name for name in found if len(found) == 1 or _works(name)]
    working = tried[0] if tried else None
    if working is None:
        raise RendererError(f"The simulated drone cannot see: {_missing(found)}")
    try:
        context = importlib.import_module(f"mujoco.{working}").GLContext
    except (ImportError, AttributeError, OSError) as error:
        # PyOpenGL is bound to one library for the life of a process.
        raise RendererError(
            f"The simulated drone cannot see: {working} works, but not in this process ({error}); "
            "start a new one"
        ) from error
    try:
        context(16, 16).free()
    except Exception as error:  # what EGL and PyOpenGL raise has no common base
        raise RendererError(
            f"The simulated drone cannot see ({error}): {_missing([working])}"
        ) from error
    return mujoco, context


def why_not() -> str:
    """Say why there is no simulated drone here; empty when there is one."""
    try:
        load()
    except RendererError as error:
        return str(error)
    return ""
