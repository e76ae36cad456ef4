"""Grading on a Dask cluster: a real scheduler and two workers, on this machine's loopback."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest
from test_runner import HERE, HIDDEN, Quiet, processes, submit, wait_for

from course_lib.grading import report, travel
from course_lib.grading.cluster import Cluster, ClusterError
from course_lib.grading.messages import Settings
from course_lib.grading.runner import Options, Outcome, grade_class
from course_lib.grading.sandbox import Limits

ROOT = HERE.parents[1]


@contextmanager
def dask(*arguments: str, where: Path) -> Iterator[subprocess.Popen]:
    env = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{HERE}"}
    with (where / "log").open("ab") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]],
            stdout=log,
            stderr=log,
            cwd=where,
            env=env,
            start_new_session=True,
        )
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    where = tmp_path_factory.mktemp("scheduler")
    options = [
        "--host",
        "127.0.0.1",
        "--port",
        "0",
        "--no-dashboard",
        "--scheduler-file",
        "at.json",
    ]
    with dask("dask_scheduler", *options, where=where):
        wait_for((where / "at.json").exists)
        wait_for((where / "at.json").read_text)
        yield json.loads((where / "at.json").read_text())["address"]


@contextmanager
def dask_worker(scheduler: str, where: Path) -> Iterator[subprocess.Popen]:
    where.mkdir()
    options = ["--host", "127.0.0.1", "--nthreads", "1", "--no-dashboard", "--no-nanny"]
    with dask("dask_worker", scheduler, *options, where=where) as process:
        wait_for(lambda: "Registered to" in (where / "log").read_text() or process.poll())
        assert process.poll() is None, (where / "log").read_text()
        yield process


@pytest.fixture
def workers(scheduler: str, tmp_path: Path) -> Iterator[list[subprocess.Popen]]:
    with (
        dask_worker(scheduler, tmp_path / "w1") as one,
        dask_worker(scheduler, tmp_path / "w2") as two,
    ):
        yield [one, two]


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    (tmp_path / "hidden").mkdir()
    (tmp_path / "hidden" / "test_4_1.py").write_text(HIDDEN)
    return Settings(
        seed=b"a secret of the instructor's",
        tests=tmp_path / "hidden",
        exercises=("4.1",),
        sandbox="none",
        limits=Limits(wall_s=20),
        grade="stand_ins:grade",
        grace_s=2,
    )


def grade(scheduler: str, settings: Settings, tmp_path: Path) -> Outcome:
    cluster = Cluster(scheduler)
    cluster.settings = settings
    assert cluster.choose("none") == "none"
    return grade_class(Options(tmp_path / "in", tmp_path / "out", settings), cluster, Quiet())


def score(tmp_path: Path, student: str) -> float:
    return report.read_summary(report.student_folder(tmp_path / "out", student)).score


@pytest.mark.usefixtures("workers")
def test_a_class_is_graded_and_nobody_disturbs_a_neighbour(scheduler, settings, tmp_path):
    submit(
        tmp_path / "in",
        ann="pass",
        ben="segfault",
        cat="kernel 1 + 1",
        dan="hang",
        eve="raise x",
        fay="where",
    )
    outcome = grade(scheduler, settings, tmp_path)
    names = ("ann", "ben", "cat", "dan", "eve", "fay")
    assert [score(tmp_path, name) for name in names] == [2, 0, 2, 0, 0, 2]
    assert set(outcome.failures) == {"eve"}
    assert grade(scheduler, settings, tmp_path).graded == ["eve"]


def test_a_lost_machine_costs_nothing(scheduler, settings, tmp_path, workers):
    mark = f"lost-{os.getpid()}"
    root = submit(tmp_path / "in", **{f"s{i}": "sleep 2" for i in range(6)})
    submit(root, s0=f"leave_processes {mark}\nsleep 4")
    killer = threading.Thread(
        target=lambda: (wait_for(lambda: processes(mark)), workers[0].kill()), daemon=True
    )
    killer.start()
    outcome = grade(scheduler, settings, tmp_path)
    killer.join()
    assert workers[0].wait(10) == -signal.SIGKILL
    assert not outcome.failures
    assert [score(tmp_path, f"s{i}") for i in range(6)] == [2] * 6
    wait_for(lambda: not processes(mark))


@pytest.mark.usefixtures("workers")
def test_an_interruption_ends_what_runs_on_the_cluster(scheduler, settings, tmp_path):
    mark = f"cancelled-{os.getpid()}"
    submit(tmp_path / "in", ann=f"leave_processes {mark}\nsleep 150", ben="pass", cat="sleep 150")
    settings = replace(settings, limits=Limits(wall_s=200))

    def interrupt() -> None:
        ben = tmp_path / "out/ben/results.json"
        wait_for(lambda: len(processes(mark)) == 5 and ben.exists(), seconds=100)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt, daemon=True)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        grade(scheduler, settings, tmp_path)
    thread.join()
    wait_for(lambda: not processes(mark))
    assert not (tmp_path / "out/ann").exists()
    assert score(tmp_path, "ben") == 2


def test_a_cluster_that_cannot_help_says_why(scheduler):
    with pytest.raises(ClusterError, match="no Dask scheduler answers"):
        Cluster("tcp://127.0.0.1:9")
    cluster = Cluster(scheduler)
    with pytest.raises(ClusterError, match="has no workers"):
        cluster.choose(None)


def test_files_travel_as_they_are(tmp_path):
    there, here = tmp_path / "there", tmp_path / "here"
    (there / "ann" / "deep" / "er").mkdir(parents=True)
    (there / "ann" / "deep" / "run.py").write_bytes(b"#!x\r\n\xff\x00")
    (there / "ann" / "deep" / "run.py").chmod(0o755)
    (there / "ann" / "link").symlink_to("/etc/passwd")
    (there / "ann" / "loop").symlink_to(".")
    os.mkfifo(there / "ann" / "pipe")
    os.link(there / "ann" / "deep" / "run.py", there / "ann" / "again.py")
    (there / "outside").write_text("secret")
    os.link(there / "outside", there / "ann" / "taken.txt")
    with (there / "ann" / "huge").open("wb") as file:
        file.truncate(200 * 2**20)
    (there / "ann" / os.fsdecode(b"\xff\xfe")).mkdir()
    (there / "ann.zip").write_bytes(b"PK")
    entries, content = travel.pack([there / "ann", there / "ann.zip"])
    assert len(content) < 1000
    here.mkdir()
    entries = json.loads(json.dumps(entries))
    assert travel.unpack(entries, content, here) == [here / "ann", here / "ann.zip"]

    def described(root: Path) -> list[tuple]:
        found = []
        for path in sorted(root.rglob("*")):
            status = path.lstat()
            what = str(path.readlink()) if path.is_symlink() else status.st_size
            if path.is_dir() and not path.is_symlink():
                what = "folder"
            found.append((str(path.relative_to(root)), status.st_mode, what, status.st_nlink > 1))
        return found

    (there / "outside").rename(tmp_path / "outside")
    assert described(here) == described(there)
    assert (here / "ann/deep/run.py").read_bytes() == b"#!x\r\n\xff\x00"


@pytest.mark.parametrize("name", ["../x", "/x", "a/../../x", "a//x", ".", ""])
def test_nothing_is_unpacked_elsewhere(tmp_path, name):
    (tmp_path / "here").mkdir()
    entry = {"name": name, "kind": "file", "mode": 0o644, "size": 0, "bytes": 0}
    with pytest.raises(ValueError, match="leads out"):
        travel.unpack([entry], b"", tmp_path / "here")
    assert [re.sub(r".*/", "", str(p)) for p in tmp_path.rglob("*")] == ["here"]
