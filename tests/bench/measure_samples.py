"""
Ask the hidden tests about the correct samples, on many secret seeds.

    python tests/bench/measure_samples.py [--seeds N] [--first N] [--sample KIND/NAME …]

Right submissions must get every point whatever the seed, in whatever style. No sandbox: each
sample's cells run once, in this process, and those tests that depend on the seed question their
functions and nodes. So a grading of Exercise 4.1 takes a second. `measure_seeds.py` grades the
solutions as `course grade` does, which takes ten times as long.
"""

from __future__ import annotations

import argparse
import inspect
import io
import logging
import sys
from collections import Counter
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace

import matplotlib as mpl
import nbformat
from IPython.core.interactiveshell import InteractiveShell

sys.path.append(str(Path(__file__).parents[1] / "grading" / "samples"))
sys.path.append(str(Path(__file__).parents[1] / "hidden"))

import test_4_1_locate
import test_4_1_matches
import test_4_1_parts
import test_4_2_locate
import test_4_2_package
import test_4_2_parts

import build
from course_lib.grading import agent
from course_lib.grading.replies import StudentError, outcome
from course_lib.grading.rubric import Grade, GradeFailed
from course_lib.grading.sandbox.places import lay_out_pictures
from course_lib.grading.seeds import Seeds
from course_lib.grading.student import Student
from course_lib.grading.submission import Source, stage
from course_lib.grading.wire import encode

ABOUT = {
    "4.1": (test_4_1_parts, test_4_1_matches, test_4_1_locate),
    "4.2": (test_4_2_parts, test_4_2_locate, test_4_2_package),
}


class Shell(InteractiveShell):
    """Runs cells; `%matplotlib inline` has nothing to show to."""

    def enable_gui(self, gui=None):
        """Do nothing."""

    def init_history(self):
        """Remember nothing."""
        super().init_history()
        self.history_manager.enabled = False


class Here(Student):
    """A notebook's functions, in this process."""

    def __init__(self, notebook):
        super().__init__(SimpleNamespace(cells=[], pictures=[]), 0.0)
        Shell.clear_instance()
        shell = Shell.instance()
        self.failed = []
        for cell in nbformat.read(notebook, as_version=4).cells:
            if cell.cell_type == "code":
                result = shell.run_cell(cell.source, store_history=True)
                self.failed += [] if result.success else [repr(result.error_in_exec)]
        self._agent = agent._Agent(SimpleNamespace(shell=shell))

    def _request(self, what, operation, arguments, seconds):
        del seconds
        try:
            tree, buffers = encode(self._agent._operations[operation](**arguments))
            reply = {"status": "ok", "value": tree}
        except Exception as error:  # noqa: BLE001  (as the agent does)
            reply, buffers = {"status": "error", **agent._describe(error)}, []
        return outcome(what, reply, buffers)


class Sample:
    """A sample that has been run, and what came of it."""

    def __init__(self, name, exercise, folder):
        self.name, self.exercise, self.folder = name, exercise, folder / "work" / Path(name).name
        source = build.build(name, folder / "in" / Path(name).name)
        notebook = stage(Source("student", (source,)), self.folder).notebooks[exercise]
        lay_out_pictures(self.folder)
        with chdir(self.folder), silence():
            self.student = Here(notebook)
        self.full, self.lost = 0, Counter()

    def ask(self, seeds):
        """Yield the number, the share that was reached and the messages where points were lost."""
        tests = [
            test
            for module in ABOUT[self.exercise]
            for name, test in vars(module).items()
            if name.startswith("test_") and name != "test_runs"
        ]
        for test in tests:
            grade = Grade()
            given = {"student": self.student, "grade": grade, "seeds": seeds}
            try:
                with chdir(self.folder), silence():
                    test(**{name: given[name] for name in inspect.signature(test).parameters})
            except StudentError as error:
                grade.lose(str(error))
            except GradeFailed:
                pass
            if grade.fraction < 1:
                yield test.pytestmark[0].args[1], grade.fraction, grade.messages


def silence():
    """Take what students print."""
    return redirect_stdout(io.StringIO())


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument(
        "--sample", nargs="+", default=build.names("correct"), metavar="correct/NAME"
    )
    options = parser.parse_args()
    mpl.use("agg")
    with TemporaryDirectory() as folder, redirect_stderr(io.StringIO()):
        samples = [
            Sample(name, exercise, Path(folder))
            for name in options.sample
            for exercise in build.expected(name)["exercises"]
        ]
        logging.disable()
        # Scenes are kept for a while, so that all are asked about one seed's before the next.
        for number in range(options.first, options.first + options.seeds):
            for each in samples:
                found = list(each.ask(Seeds(b"measured with seed %06d" % number)))
                each.full += not found
                each.lost.update(test for test, *_ in found)
                for test, share, messages in found:
                    print(f"    {each.name}, seed {number}: {test} {share:.3f} {messages}")
            print(f"seed {number} is done", flush=True)
    for each in samples:
        where = f", lost in {dict(each.lost)}" if each.lost else ""
        failed = f"; cells failed: {each.student.failed}" if each.student.failed else ""
        print(f"{each.name}: full marks on {each.full} of {options.seeds} seeds{where}{failed}")
    right = sum(each.full == options.seeds for each in samples)
    print(f"full marks on every seed: {right} of {len(samples)}")


if __name__ == "__main__":
    main()
