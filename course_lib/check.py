"""
What students check themselves with.

In a notebook, ``from course_lib import check`` gives a module that can be called:
``check("4.1")`` checks the whole exercise and ``check("4.1", "load_images")`` one function of it.
On the command line it is ``course check exercises/exercise_4_1.ipynb``.
"""

from __future__ import annotations

import contextlib
import importlib
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

from course_lib.checks.work import Work, run

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator, Mapping

    from course_lib.checks.table import Table

EXERCISES = {
    "4.1": "course_lib.checks.exercise_4_1",
    "4.2": "course_lib.checks.exercise_4_2",
}


def check(exercise: str, *functions: str, namespace: Mapping[str, Any] | None = None) -> Table:
    """
    Check an exercise on pictures that everybody may see.

    Parameters
    ----------
    exercise : str
        "4.1" or "4.2".
    *functions : str
        Check only these; default everything.
    namespace : mapping, optional
        Where the functions are; default the notebook's, or the caller's.

    Returns
    -------
    Table
        End a cell with it, and the notebook shows it.

    Raises
    ------
    ValueError
        No such exercise, or it has no such function.
    """
    if exercise not in EXERCISES:
        raise ValueError(f"no exercise {exercise!r}; there are {', '.join(EXERCISES)}")
    checks = importlib.import_module(EXERCISES[exercise]).CHECKS
    known = dict.fromkeys(each.function for each in checks)
    if strange := [name for name in functions if name not in known]:
        raise ValueError(f"exercise {exercise} asks for {', '.join(known)}, not for {strange[0]!r}")
    wanted = [each for each in checks if not functions or each.function in functions]
    return run(exercise, wanted, Work(_callers_names() if namespace is None else namespace))


@contextlib.contextmanager
def when_done() -> Iterator[None]:
    """
    Run the block below, or say kindly what is not written yet.

    That may be a part of the notebook, or of a ROS node that the block runs.

    Examples
    --------
    >>> with when_done():
    ...     raise NotImplementedError("step 1: load both pictures")
    Not yet: step 1: load both pictures.
    """
    try:
        yield
    except NotImplementedError as error:
        _say_not_yet(str(error))
    except Exception as error:
        # offline_ros.NodeError has the traceback of the node, which ran in another process.
        kind, _, hint = getattr(error, "traceback", "").strip().rpartition("\n")[2].partition(":")
        if kind != NotImplementedError.__name__:
            raise
        _say_not_yet(hint)


def _say_not_yet(hint: str) -> None:
    what = hint.strip().rstrip(".") or "a part of this is not written"
    print(f"Not yet: {what}.")  # noqa: T201


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``course check``."""
    from course_lib.checks import command  # noqa: PLC0415 (not needed in a notebook)

    command.add_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Run ``course check``; return the exit status (0: all is right)."""
    from course_lib.checks import command  # noqa: PLC0415 (not needed in a notebook)

    return command.check_notebooks(args)


def _callers_names() -> Mapping[str, Any]:
    """Return the names of the first caller outside this file."""
    frame = sys._getframe(1)  # noqa: SLF001
    while frame.f_globals.get("__name__") == __name__ and frame.f_back is not None:
        frame = frame.f_back
    # At the top level of a notebook's cell these are the notebook's own names.
    return {**frame.f_globals, **frame.f_locals}


class _CallableModule(ModuleType):
    """Lets ``check("4.1")`` read as it should, without another name to import."""

    def __call__(self, exercise: str, *functions: str, **options: Any) -> Table:  # noqa: ANN401
        """Check an exercise; see `check`."""
        return check(exercise, *functions, **options)


sys.modules[__name__].__class__ = _CallableModule
