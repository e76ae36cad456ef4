"""The command ``course``: checks an exercise, grades a class, makes what students are given."""

from __future__ import annotations

import argparse
import importlib
import sys
from importlib.util import find_spec
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

# Module, and what it is for. The students' bundle comes without the grader's.
_COMMANDS = {
    "check": ("course_lib.check", "check your own exercise before you hand it in"),
    "grade": ("course_lib.grading.cli", "grade a folder of submissions"),
    "export": ("course_lib.grading.exports", "write grades for Canvas, Moodle, Gradescope"),
    "release": ("course_lib.grading.release", "make the exercises and the students' bundle"),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    arguments : sequence of str, optional
        By default those of the process.

    Returns
    -------
    int
        The exit status.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    parser = argparse.ArgumentParser(
        prog="course", description="Work with the exercises of this course."
    )
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    chosen = None
    for name, (module, purpose) in _COMMANDS.items():
        if _exists(module):
            command = commands.add_parser(
                name, help=purpose, description=f"{purpose.capitalize()}."
            )
            if given[:1] == [name]:  # what the others need would take a second to import
                chosen = importlib.import_module(module)
                chosen.add_arguments(command)
    options = parser.parse_args(given)
    return int(chosen.main(options)) if chosen else 2


def _exists(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:
        return False


if __name__ == "__main__":
    sys.exit(main())
