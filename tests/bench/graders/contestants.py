"""The ways to grade that are compared: ours, nbgrader, otter-grader, and a script alone."""

from __future__ import annotations

import csv
import json
import re
import shutil
import sys
from abc import ABC, abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING

from graders import assignment, peers, usage
from graders.assignment import NAME, all_checks, cells, helpers, notebook, put_pictures, write

if TYPE_CHECKING:
    from collections.abc import Sequence

    from graders.memory import Peaks
    from graders.usage import Spent

RUN_CHECKS = "from types import SimpleNamespace\n\n{check}(SimpleNamespace(**globals()))\n"


class Contestant(ABC):
    """Grades a class in some way.

    Parameters
    ----------
    folder : Path
        A new folder of its own.
    """

    title: str
    most: int | None = None  # submissions in a round; for who starts anew for each of them

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True)

    @abstractmethod
    def submit(self, student: str, sources: list[str]) -> None:
        """Put a student's notebook where it is graded from."""

    @abstractmethod
    def withdraw(self, student: str) -> None:
        """Take a submission back."""

    @abstractmethod
    def run(self, students: Sequence[str]) -> Spent:
        """Grade all that was submitted, from nothing."""

    @abstractmethod
    def scores(self) -> dict[str, float]:
        """Give each student's points, of 8."""


class Script(Contestant):
    """No grader: the student's code and the checks in one script, the same calls.

    One alone runs as its author would run it, with OpenCV's threads on every processor; two at a
    time show what the machine can do at best.
    """

    def __init__(self, folder: Path, at_once: int) -> None:
        super().__init__(folder)
        self.title = self.titled(at_once)
        self._at_once = at_once

    @staticmethod
    def titled(at_once: int) -> str:
        """Give the title of so many scripts at a time."""
        return "python solution.py" + (f", {at_once} at a time" if at_once > 1 else "")

    def submit(self, student: str, sources: list[str]) -> None:
        put_pictures(self.folder / student)
        count = "\nprint(sum(map(passes, (*PUBLIC, *HIDDEN))))\n"
        passes = (
            "\n\ndef passes(check):\n    try:\n        check(student)\n"
            "    except AssertionError:\n        return False\n    return True\n\n"
        )
        text = "\n\n".join(sources) + "\n\n" + assignment.CHECKS.read_text("utf-8") + passes
        text += "from types import SimpleNamespace\nstudent = SimpleNamespace(**globals())" + count
        (self.folder / student / "solution.py").write_text(text)

    def withdraw(self, student: str) -> None:
        shutil.rmtree(self.folder / student)

    def run(self, students: Sequence[str]) -> Spent:
        each = f"cd {{}} && exec '{sys.executable}' solution.py > score.txt"
        command = [
            "xargs",
            "-a",
            "students",
            "-P",
            str(self._at_once),
            "-I{}",
            "/bin/sh",
            "-c",
            each,
        ]
        (self.folder / "students").write_text("\n".join(students) + "\n")
        return usage.run(command, self.folder)

    def scores(self) -> dict[str, float]:
        found = self.folder.glob("*/score.txt")
        return {path.parent.name: float(path.read_text().split()[-1]) for path in found}


class Ours(Contestant):
    """``course grade``, sandbox and all."""

    def __init__(self, folder: Path, workers: int) -> None:
        super().__init__(folder)
        self.title = f"course grade, {workers} worker{'s' if workers > 1 else ''}, sandboxed"
        self.workers = workers
        self.watch: Peaks | None = None
        tests = folder / "hidden"
        put_pictures(tests)
        shutil.copyfile(assignment.CHECKS, tests / "checks.py")
        text = "import checks\nfrom course_lib.grading.rubric import points\n\nEXERCISE = '4.1'\n"
        for number, check in enumerate(all_checks(), start=1):
            mark = f"@points(1, '4.1.{number}', {check.name!r})"
            text += f"\n\n{mark}\ndef test_{number}(student, grade):\n"
            text += f"    try:\n        checks.{check.name}(student)\n"
            text += "    except AssertionError:\n        grade.fail('No.')\n"
        (tests / "test_4_1_bench.py").write_text(text)
        (folder / "seed").write_text("a secret of 16 bytes and more\n")
        (folder / "seed").chmod(0o600)

    def submit(self, student: str, sources: list[str]) -> None:
        put_pictures(self.folder / "submissions" / student)
        write(notebook(sources), self.folder / "submissions" / student / f"{NAME}.ipynb")

    def withdraw(self, student: str) -> None:
        shutil.rmtree(self.folder / "submissions" / student)

    def run(self, students: Sequence[str]) -> Spent:
        shutil.rmtree(self.folder / "out", ignore_errors=True)
        command = [Path(sys.executable).with_name("course"), "grade", "submissions"]
        command += ["--out", "out", "--exercise", "4.1", "--tests", "hidden"]
        command += ["--seed-file", "seed", "--workers", str(self.workers), "--only", *students]
        return usage.run(command, self.folder, watch=self.watch.look if self.watch else None)

    def scores(self) -> dict[str, float]:
        found = (self.folder / "out").glob("*/results.json")
        return {path.parent.name: json.loads(path.read_bytes())["score"] for path in found}


class Nbgrader(Contestant):
    """``nbgrader autograde`` of the whole class, as it comes."""

    title = f"nbgrader {peers.NBGRADER.version} autograde, batch"

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        config = "c = get_config()\nc.CourseDirectory.course_id = 'bench'\n"
        (folder / "nbgrader_config.py").write_text(config)
        put_pictures(folder / "source" / "ps1")
        write(self._notebook(cells("teacher")), folder / "source" / "ps1" / f"{NAME}.ipynb")
        peers.NBGRADER.run("generate_assignment", "ps1", folder=folder)
        shutil.copyfile(folder / "gradebook.db", folder / "gradebook.new")

    @staticmethod
    def _notebook(sources: list[str]):
        """Make the source notebook: solutions, helpers, a cell for each check."""
        marked = [f"### BEGIN SOLUTION\n{source}\n### END SOLUTION" for source in sources]
        made = [_cell(f"solution-{number}", solution=True) for number in range(len(sources))]
        marked.append(helpers())
        made.append(_cell("helpers"))
        for check in all_checks():
            text = f"{check.source}\n\n{RUN_CHECKS.format(check=check.name)}"
            if check.hidden:
                text = f"### BEGIN HIDDEN TESTS\n{text}### END HIDDEN TESTS"
            marked.append(text)
            made.append(_cell(check.name, points=1))
        return notebook(marked, made)

    def submit(self, student: str, sources: list[str]) -> None:
        released = self.folder / "release" / "ps1"
        target = self.folder / "submitted" / student / "ps1"
        shutil.copytree(released, target)
        content = json.loads((released / f"{NAME}.ipynb").read_text("utf-8"))
        for cell in content["cells"]:
            number = re.fullmatch(r"solution-(\d+)", cell["metadata"]["nbgrader"]["grade_id"])
            if number:
                cell["source"] = sources[int(number[1])]
        (target / f"{NAME}.ipynb").write_text(json.dumps(content), "utf-8")

    def withdraw(self, student: str) -> None:
        shutil.rmtree(self.folder / "submitted" / student)

    def run(self, students: Sequence[str]) -> Spent:
        shutil.rmtree(self.folder / "autograded", ignore_errors=True)
        shutil.copyfile(self.folder / "gradebook.new", self.folder / "gradebook.db")
        submitted = sorted(path.name for path in (self.folder / "submitted").iterdir())
        if submitted != sorted(students):
            raise ValueError("it grades all that is submitted, or what was named one by one")
        return peers.NBGRADER.run("autograde", "ps1", folder=self.folder)

    def scores(self) -> dict[str, float]:
        peers.NBGRADER.run("export", "--to=grades.csv", folder=self.folder)
        with (self.folder / "grades.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        return {row["student_id"]: float(row["score"]) for row in rows}


def _cell(name: str, *, solution: bool = False, points: int = 0) -> dict[str, object]:
    metadata = {"grade_id": name, "schema_version": 3, "task": False, "cell_type": "code"}
    metadata |= {"solution": solution, "grade": points > 0, "locked": not solution}
    return {"nbgrader": metadata | ({"points": points} if points else {})}


class Otter(Contestant):
    """``otter run``, one submission after the other, each from nothing as it wants it."""

    title = f"otter-grader {peers.OTTER.version} run"
    most = 5

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        put_pictures(folder)
        shutil.copyfile(assignment.CHECKS, folder / "checks.py")
        (folder / "tests").mkdir()
        names = "load_images, find_keypoints, match_keypoints, locate_mug"
        for check in all_checks():
            text = "from types import SimpleNamespace\n\nimport checks\n"
            text += "from otter.test_files import test_case\n\nOK_FORMAT = False\n"
            text += f"name, points = {check.name!r}, 1\n\n\n"
            text += f"@test_case(points=1, hidden={check.hidden})\ndef test({names}):\n"
            text += f"    checks.{check.name}(SimpleNamespace(**locals()))\n"
            (folder / "tests" / f"{check.name}.py").write_text(text)
        files = ["checks.py", *assignment.SIZES]
        peers.OTTER.run("generate", "-t", "tests", *files, folder=folder)

    def submit(self, student: str, sources: list[str]) -> None:
        write(notebook(sources), self.folder / "submissions" / student / f"{NAME}.ipynb")

    def withdraw(self, student: str) -> None:
        shutil.rmtree(self.folder / "submissions" / student)

    def run(self, students: Sequence[str]) -> Spent:
        shutil.rmtree(self.folder / "out", ignore_errors=True)
        total = usage.Spent(0.0, 0.0)
        for student in students:
            out = self.folder / "out" / student
            out.mkdir(parents=True)
            arguments = ["run", "-a", "autograder.zip", "-o", out, "--no-logo"]
            arguments.append(f"submissions/{student}/{NAME}.ipynb")
            total += peers.OTTER.run(*arguments, folder=self.folder)
        return total

    def scores(self) -> dict[str, float]:
        found = {}
        for path in (self.folder / "out").glob("*/results.json"):
            tests = json.loads(path.read_bytes())["tests"]
            found[path.parent.name] = sum(test.get("score") or 0.0 for test in tests)
        return found
