"""The runner: every submission gets a result, whatever happens to the one beside it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from course_lib.grading import report
from course_lib.grading.messages import Finished, Settings
from course_lib.grading.pool import Pool
from course_lib.grading.runner import GONE, Options, Outcome, UsageError, grade_class
from course_lib.grading.sandbox import Limits
from course_lib.grading.scratch import remove
from course_lib.grading.summary import INSTRUCTOR

HERE = Path(__file__).parent
HIDDEN = '''
from course_lib.grading.rubric import points
EXERCISE = "4.1"

@points(2, "4.1.1", "Does it")
def test_it(student):
    """Does it."""
'''


class Quiet:
    """Keeps what a run tells."""

    def __init__(self) -> None:
        self.total = 0
        self.running: list[str] = []
        self.finished_events: list[Finished] = []

    def start(self, total: int, outcome: Outcome) -> None:
        self.total = total
        self.unchanged = list(outcome.unchanged)

    def started(self, student: str) -> None:
        self.running.append(student)

    def finished(self, event: Finished) -> None:
        self.finished_events.append(event)

    def stop(self) -> None:
        self.total = -1


@pytest.fixture(autouse=True)
def stand_ins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(HERE))


@pytest.fixture(autouse=True)
def temporary(
    monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Path]:
    """A folder for temporary files that no other test uses, its path short enough for sockets."""
    tmp_path_factory.getbasetemp()  # is not to lie in there
    folder = Path(tempfile.mkdtemp(prefix="run-", dir="/tmp"))
    folder.chmod(0o711)
    monkeypatch.setenv("TMPDIR", str(folder))
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    yield folder
    remove(folder)


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    tests = tmp_path / "hidden"
    tests.mkdir()
    (tests / "test_4_1.py").write_text(HIDDEN)
    return Settings(
        seed=b"a secret of the instructor's",
        tests=tests,
        exercises=("4.1",),
        sandbox="none",
        limits=Limits(wall_s=20),
        grade="stand_ins:grade",
        grace_s=2,
    )


def submit(root: Path, **deeds: str) -> Path:
    for student, deed in deeds.items():
        (root / student).mkdir(parents=True, exist_ok=True)
        (root / student / "do.txt").write_text(deed)
    return root


@pytest.fixture
def run(tmp_path: Path, settings: Settings) -> Callable[..., tuple[Outcome, Quiet]]:
    def run(*, workers: int = 2, wall_s: float = 20, **more) -> tuple[Outcome, Quiet]:
        used = replace(settings, limits=Limits(wall_s=wall_s), **more.pop("settings", {}))
        options = Options(tmp_path / "in", tmp_path / "out", used, **more)
        seen = Quiet()
        return grade_class(options, Pool(used, workers), seen), seen

    return run


def result(out: Path, student: str) -> dict:
    return json.loads((out / student / "results.json").read_text())


def processes(mark: str) -> list[int]:
    """Processes with a word in their command line."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                if mark.encode() in (entry / "cmdline").read_bytes():
                    found.append(int(entry.name))
            except OSError:
                continue
    return found


def test_everybody_gets_a_result_and_nobody_disturbs_a_neighbour(tmp_path, temporary, run):
    root = submit(
        tmp_path / "in",
        ada="pass",
        bob="segfault",
        cleo="raise a <b>bad</b> thing",
        dan="exit 3",
        eve="hog",
        finn="print",
        gus="kernel 1 + 1",
        hal="pass",
    )
    outcome, seen = run(settings={"own_bytes": 800 * 2**20})
    out = tmp_path / "out"
    scores = {path.name: result(out, path.name)["score"] for path in root.iterdir()}
    assert scores == dict.fromkeys(["ada", "finn", "gus", "hal"], 2) | dict.fromkeys(
        ["bob", "cleo", "dan", "eve"], 0
    )
    assert sorted(outcome.graded) == sorted(scores)
    assert sorted(seen.running) == sorted(scores)
    for name in ("bob", "cleo", "dan", "eve"):
        (test,) = result(out, name)["tests"]  # which tests there are is known all the same
        assert test["extra_data"]["status"] == "not_checked"
        assert test["max_score"] == 2
        assert "your instructor has been told" in test["output"]
        assert "could not be checked" in result(out, name)["extra_data"]["events"][0]
    assert "SIGSEGV" in str(result(out, "bob")["extra_data"]["events"])
    assert "status 3" in str(result(out, "dan")["extra_data"]["events"])
    assert "ValueError" in outcome.failures["cleo"]
    assert "MemoryError" in outcome.failures["eve"]
    assert set(outcome.failures) == {"cleo", "eve"}
    assert outcome.status == 1
    assert list(temporary.iterdir()) == []
    assert (out / "index.html").is_file()
    assert "ada" in (out / "grades.csv").read_text()


def test_a_hang_is_ended_with_its_sandbox(tmp_path, temporary, run):
    submit(tmp_path / "in", hank="kernel 0\nhang", ida="pass")
    outcome, _ = run(wall_s=1)
    assert outcome.status == 0  # there is a result
    assert "longer than 3 s" in str(result(tmp_path / "out", "hank")["extra_data"]["events"])
    assert result(tmp_path / "out", "ida")["score"] == 2
    assert list(temporary.iterdir()) == []


def test_what_a_grading_leaves_behind_is_gone_before_the_next_begins(tmp_path, run):
    mark = f"left-behind-{os.getpid()}"
    submit(
        tmp_path / "in",
        a=f"leave_processes {mark}\nleave_files {mark}",
        b=f"count {mark}",
    )
    outcome, _ = run(workers=1)
    assert not outcome.failures
    assert result(tmp_path / "out", "b")["extra_data"]["events"] == ["0 processes, 0 files"]
    assert processes(mark) == []


@pytest.mark.parametrize(
    "deed", ["segfault", "kill_parent", "sandbox_fails now", "kill_zygote\nsandbox_fails x"]
)
def test_a_crash_by_chance_is_tried_again(tmp_path, run, deed):
    submit(tmp_path / "in", mia="\n".join(f"once {line}" for line in deed.splitlines()), noa="pass")
    outcome, _ = run()
    assert not outcome.failures
    assert result(tmp_path / "out", "mia")["score"] == 2


def test_a_worker_that_dies_each_time_costs_one_submission(tmp_path, run):
    submit(tmp_path / "in", kim="kill_parent", lou="pass", max="pass")
    outcome, _ = run(workers=1)
    assert set(outcome.failures) == {"kim"}
    assert "SIGKILL" in outcome.failures["kim"]
    assert result(tmp_path / "out", "kim")["tests"][0]["max_score"] == 2
    assert result(tmp_path / "out", "max")["score"] == 2


def test_what_cannot_be_shown_keeps_its_points_and_stops_nobody(tmp_path, run):
    submit(tmp_path / "in", ann="unwritable", ben="pass")
    outcome, _ = run()
    assert set(outcome.failures) == {"ann"}
    assert "could not be written" in outcome.failures["ann"]
    assert [result(tmp_path / "out", name)["score"] for name in ("ann", "ben")] == [2, 2]


def test_a_zygote_that_died_is_replaced(tmp_path, run):
    submit(tmp_path / "in", a="kill_zygote", b="kernel 1 + 1", c="kernel 1 + 1")
    outcome, _ = run(workers=1)
    assert not outcome.failures
    assert result(tmp_path / "out", "b")["extra_data"]["events"] == ["ok"]


def test_only_what_is_new_or_changed_is_graded(tmp_path, run):
    root = submit(tmp_path / "in", ann="pass", ben="pass", cat="pass")
    assert sorted(run()[0].graded) == ["ann", "ben", "cat"]
    before = (tmp_path / "out/ann/results.json").stat().st_mtime_ns
    submit(root, ben="pass\npass", dot="pass")
    outcome, seen = run()
    assert sorted(outcome.graded) == ["ben", "dot"]
    assert outcome.unchanged == ["ann", "cat"]
    assert seen.running == ["ben", "dot"]
    assert (tmp_path / "out/ann/results.json").stat().st_mtime_ns == before
    assert run()[0].graded == []
    assert run(only=("cat",), fresh=True)[0].graded == ["cat"]
    assert run(settings={"seed": b"another secret, as long"})[0].unchanged == []


def test_what_the_grader_could_not_grade_is_tried_by_the_next_run(tmp_path, run):
    submit(tmp_path / "in", ann="raise x", ben="exit 3", cat="pass")
    assert run()[0].status == 1
    outcome, _ = run()
    assert outcome.graded == ["ann"]
    assert outcome.unchanged == ["ben", "cat"]


def test_a_damaged_result_is_made_anew(tmp_path, run):
    submit(tmp_path / "in", ann="pass")
    run()
    (tmp_path / "out/ann/results.json").write_text("{")
    assert run()[0].graded == ["ann"]
    assert result(tmp_path / "out", "ann")["score"] == 2


def test_results_of_who_has_gone_are_kept_and_listed(tmp_path, run):
    root = submit(tmp_path / "in", ann="pass", ben="pass")
    run()
    (root / "ben" / "do.txt").unlink()
    (root / "ben").rmdir()
    assert run()[0].gone == ["ben"]
    assert result(tmp_path / "out", "ben")["score"] == 2
    assert (tmp_path / "out" / INSTRUCTOR / GONE).read_text() == "ben\n"
    submit(root, ben="pass")
    assert run()[0].gone == []
    assert not (tmp_path / "out" / INSTRUCTOR / GONE).exists()


def test_memory_does_not_grow(tmp_path, run):
    submit(tmp_path / "in", **{f"s{i:02}": "memory" for i in range(30)})
    run(workers=1)
    events = [result(tmp_path / "out", f"s{i:02}")["extra_data"]["events"][0] for i in range(30)]
    pages = [int(event.split()[1]) for event in events]
    assert max(pages[10:]) - pages[5] < 256  # a megabyte


def test_folders_that_make_no_sense_are_refused(tmp_path, run, settings):
    with pytest.raises(UsageError, match="no folder"):
        run()
    (tmp_path / "in").mkdir()
    with pytest.raises(UsageError, match="no submissions"):
        run()
    submit(tmp_path / "in", ann="pass")
    with pytest.raises(UsageError, match="no submission of zoe"):
        run(only=("zoe",))
    for out in (tmp_path / "in", tmp_path / "in" / "grades", tmp_path):
        with pytest.raises(UsageError, match="--out"):
            grade_class(Options(tmp_path / "in", out, settings), Pool(settings, 1), Quiet())
    empty = replace(settings, tests=tmp_path / "in")
    with pytest.raises(UsageError, match="hidden tests"):
        grade_class(Options(tmp_path / "in", tmp_path / "o", empty), Pool(empty, 1), Quiet())


SCRIPT = """
import argparse, sys
from course_lib.grading import cli
parser = argparse.ArgumentParser()
cli.add_arguments(parser)
parser.set_defaults(grade="stand_ins:grade")
sys.exit(cli.main(parser.parse_args()))
"""


def course(tmp_path: Path, *arguments: str) -> subprocess.Popen:
    """Start the real command, with the stand-in grader in its seam."""
    seed = tmp_path / "seed"
    seed.write_bytes(b"0123456789abcdef")
    seed.chmod(0o600)
    command = [sys.executable, "-c", SCRIPT, str(tmp_path / "in")]
    command += ["--out", str(tmp_path / "out"), "--seed-file", str(seed), "--no-sandbox"]
    command += ["--tests", str(tmp_path / "hidden"), "--exercise", "4.1", *arguments]
    root = str(HERE.parents[1])
    env = {**os.environ, "PYTHONPATH": f"{root}{os.pathsep}{HERE}"}
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=env, cwd=tmp_path
    )


def wait_for(condition: Callable[[], object], seconds: float = 60) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.05)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
@pytest.mark.usefixtures("settings")
def test_an_interrupted_run_loses_nothing_and_leaves_nothing(tmp_path, temporary, number):
    mark = f"interrupted-{os.getpid()}-{number}"
    first = submit(
        tmp_path / "in",
        a="pass",
        b=f"leave_processes {mark}\nkernel 1\nsleep 60",
        c="pass",
        d="pass",
    )
    with course(tmp_path, "--workers", "1") as running:
        wait_for(lambda: (tmp_path / "out/a/results.json").exists() and len(processes(mark)) == 5)
        running.send_signal(number)
        _, complained = running.communicate(timeout=30)
    assert running.returncode == (-9 if number == signal.SIGKILL else 130)
    if number != signal.SIGKILL:
        assert "same command" in complained
        assert (tmp_path / "out/index.html").exists()
        assert processes(mark) == []
        assert list(temporary.iterdir()) == []
    wait_for(lambda: processes(mark) == [])
    submit(first, b="pass")
    with course(tmp_path) as again:
        said, complained = again.communicate(timeout=60)
    assert again.returncode == 0, complained
    assert "3 graded, 1 unchanged" in said
    assert list(temporary.iterdir()) == []


@pytest.mark.usefixtures("settings")
def test_two_runs_do_not_share_a_folder(tmp_path):
    submit(tmp_path / "in", a="sleep 3")
    with course(tmp_path) as first:
        wait_for((tmp_path / "out/.lock").exists)
        wait_for((tmp_path / "out/.lock").read_text)
        with course(tmp_path) as second:
            _, complained = second.communicate(timeout=30)
        assert second.returncode == 2
        assert f"another run (process {first.pid})" in complained
        first.communicate(timeout=30)
    assert first.returncode == 0


def test_nothing_in_the_current_folder_is_imported(tmp_path, run, monkeypatch):
    root = submit(tmp_path / "in", a="where\nkernel import cv2")
    for name in ("cv2", "numpy", "json", "stand_ins", "course_lib", "sitecustomize", "pytest"):
        (root / f"{name}.py").write_text("raise SystemExit('imported what a stranger wrote')")
    monkeypatch.chdir(root)
    outcome, _ = run(only=("a",))
    assert not outcome.failures
    events = result(tmp_path / "out", "a")["extra_data"]["events"]
    assert events == ["cwd /", "path []", "ok"]


def test_the_report_module_writes_what_came(tmp_path, run):
    submit(tmp_path / "in", ann="pass")
    run()
    summary = report.read_summary(report.student_folder(tmp_path / "out", "ann"))
    assert (summary.score, summary.max_score) == (2, 2)
    assert summary.fingerprint
