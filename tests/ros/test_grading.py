"""`course grade --ros`: the same hidden tests, nodes on real ROS in the sandbox, equal points."""

from __future__ import annotations

import argparse
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import nbformat
import pytest
from flight_piece import PACKAGE, ROOT

from course_lib.grading import cli
from course_lib.grading.results import SubmissionResult
from course_lib.grading.sandbox import Launcher, Limits
from course_lib.grading.session import Job, grade_one
from course_lib.offline_ros import install
from course_lib.real_ros import system

SEED = b"a seed of these tests"


@pytest.fixture(scope="module")
def launcher() -> Iterator[Launcher]:
    with Launcher("bubblewrap", Limits(processes=cli._ROS_PROCESSES)) as running:
        yield running


@pytest.fixture(scope="module")
def tests(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The hidden tests of the package alone: the others run no node."""
    folder = tmp_path_factory.mktemp("hidden")
    shutil.copy(ROOT / "tests" / "hidden" / "test_4_2_package.py", folder)
    return folder


def submission(into: Path, edit: Callable[[Path], None]) -> Path:
    shutil.copytree(PACKAGE, into / "unit4")
    edit(into / "unit4")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("pass")])
    nbformat.write(notebook, into / "exercise_4_2.ipynb")
    return into


def nothing(_: Path) -> None:
    """Hand in the solution."""


def no_check_for_none(package: Path) -> None:
    """Raise in each frame without a well; also name a template of one's own computer."""
    node = package / "src" / "exercise4_2_2.py"
    text = node.read_text()
    assert text.count("if corners is not None:") == 1
    node.write_text(text.replace("if corners is not None:", "if True:"))
    launch = package / "launch" / "exercise4_2_2.launch"
    text = launch.read_text()
    assert "$(find unit4)/waterhole.png" in text
    launch.write_text(text.replace("$(find unit4)/waterhole.png", "/home/me/waterhole.png"))
    (package / "src" / "exercise4_2_1.py").chmod(0o644)


def nothing_that_roslaunch_can_start(package: Path) -> None:
    """Leave out a suffix, the first line of a node, its executable bit, and the manifest's end."""
    launch = package / "launch" / "exercise4_2_1.launch"
    text = launch.read_text()
    assert text.count("exercise4_2_1.py") == 1
    launch.write_text(text.replace("exercise4_2_1.py", "exercise4_2_1"))
    node = package / "src" / "exercise4_2_2.py"
    first, _, rest = node.read_text().partition("\n")
    assert first.startswith("#!")
    node.write_text(rest)
    node.chmod(0o644)
    manifest = package / "package.xml"
    manifest.write_text(manifest.read_text().replace("</package>", ""))


def points(result: SubmissionResult) -> dict[str, float]:
    return {test.number: test.score for test in result.tests}


@pytest.mark.parametrize("edit", [nothing, no_check_for_none, nothing_that_roslaunch_can_start])
def test_points_are_the_same(
    edit: Callable[[Path], None], launcher: Launcher, tests: Path, tmp_path: Path
) -> None:
    folder = submission(tmp_path / "student", edit)
    offline, on_ros = (
        grade_one(Job("student", (folder,), SEED, ("4.2",), tests, ros=ros), launcher)
        for ros in (False, True)
    )
    assert not offline.events
    assert not on_ros.events
    assert points(on_ros) == points(offline), [t.output for t in (*on_ros.tests, *offline.tests)]
    whole = sum(test.max_score for test in on_ros.tests)
    assert whole == 5
    total = sum(points(on_ros).values())
    assert total == whole if edit is nothing else 1 < total < whole


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--sandbox", "sandlock"], "--ros needs bubblewrap"),
        (["--scheduler", "tcp://127.0.0.1:1"], "on this machine only"),
    ],
)
def test_what_cannot_be_is_said(
    options: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    parser = argparse.ArgumentParser()
    cli.add_arguments(parser)
    given = [str(tmp_path), "--out", str(tmp_path / "out"), "--ros", *options]
    assert cli.main(parser.parse_args(given)) == 2
    assert words in capsys.readouterr().err


def test_what_a_node_imports_offline_is_there_on_ros() -> None:
    text = "; ".join(f"import {module}" for module in install.PROVIDED)
    done = subprocess.run([system.PYTHON, "-c", text], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"add its package to `.ci/system`: {done.stderr}"
