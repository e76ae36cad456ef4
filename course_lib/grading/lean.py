"""Imports that drag nothing along: each of a grader's many processes pays for its imports."""

from __future__ import annotations

import gc
import importlib
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

# jsonschema's optional checks of formats, which nbformat never asks for. The first takes a second:
# it builds a grammar, wherever JupyterLab is installed.
_FORMATS = ("rfc3987_syntax", "isoduration")


@contextmanager
def without(*names: str) -> Iterator[None]:
    """Import in this block as if some modules were not installed; afterwards they are as before.

    Parameters
    ----------
    *names : str
        Modules that what is imported can do without.
    """
    absent = [name for name in names if name not in sys.modules]
    sys.modules.update(dict.fromkeys(absent))  # type: ignore[arg-type]  # None: cannot be imported
    try:
        yield
    finally:
        for name in absent:
            sys.modules.pop(name, None)


@contextmanager
def for_good() -> Iterator[None]:
    """Import in this block what stays for as long as the process, and its forked children, live.

    Nothing of it is garbage, and looking for some would take a tenth of the time. Later a
    collection in a child need not touch, and so copy, it.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.collect()
        gc.freeze()
        gc.enable()


def import_nbformat() -> ModuleType:
    """Import nbformat, and what it needs only.

    Returns
    -------
    module
    """
    with without(*_FORMATS):
        return importlib.import_module("nbformat")
