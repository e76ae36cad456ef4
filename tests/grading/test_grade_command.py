"""`course` and `course grade`: their help, their exit statuses, the seed file, fingerprints."""

from __future__ import annotations

import os
import re
import shutil
import stat
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from course_lib.grading import cli, framing, seed_file
from course_lib.grading.fingerprint import Fingerprints
from course_lib.grading.messages import (
    Finished,
    Settings,
    Task,
    from_message,
    to_message,
)
from course_lib.grading.progress import Shown, _Console, for_people
from course_lib.grading.results import Picture, SubmissionResult, TestResult
from course_lib.grading.runner import Outcome
from course_lib.grading.sandbox import Limits
from course_lib.grading.seeds import Seeds

ROOT = Path(__file__).parents[2]
# An editable install would find in this checkout what is not in a copy.
_OF_A_COPY = """
import sys
sys.meta_path[:] = [f for f in sys.meta_path if not f.__module__.startswith("__editable__")]
from course_lib.cli import main
sys.exit(main())
"""


def course(*arguments: object, root: Path = ROOT, **more: str) -> subprocess.CompletedProcess:
    start = ["-m", "course_lib.cli"] if root == ROOT else ["-c", _OF_A_COPY]
    return subprocess.run(
        [sys.executable, *start, *map(str, arguments)],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": str(root), "COLUMNS": "100", **more},
        cwd=root,
        timeout=60,
        check=False,
    )


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    return tmp_path


def test_help_waits_for_no_library_and_is_enough():
    loaded = "import sys; from course_lib.cli import main; sys.exit(main())"
    watched = [sys.executable, "-X", "importtime", "-c", loaded, "--help"]
    done = subprocess.run(watched, capture_output=True, text=True, check=True, cwd=ROOT)
    imported = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert "argparse" in imported
    assert not imported & {"cv2", "numpy", "nbformat", "pytest", "zmq"}
    told = done.stdout
    assert all(word in told for word in ("check", "grade", "export", "release"))
    told = course("grade", "--help").stdout
    for word in ("--out", "--seed-file", "--workers", "examples:", "exit status:", "index.html"):
        assert word in told


def test_help_names_the_limits_that_hold():
    told = course("grade", "--help").stdout
    limits = Limits()
    assert f"seconds in all ({limits.wall_s:.0f})" in told
    assert f"seconds for one cell ({limits.cell_s:.0f})" in told
    assert f"seconds for one call of a test ({limits.call_s:.0f})" in told
    assert f"({limits.memory_bytes / 2**30:.0f}G)" in told


def test_a_students_bundle_has_no_grader(tmp_path):
    shutil.copytree(
        ROOT / "course_lib",
        tmp_path / "course_lib",
        ignore=shutil.ignore_patterns("grading", "scenes", "__pycache__"),
    )
    (tmp_path / "images").symlink_to(ROOT / "images")
    told = course("--help", root=tmp_path)
    assert told.returncode == 0
    assert "check" in told.stdout
    assert "grade" not in told.stdout
    assert course("check", "--help", root=tmp_path).returncode == 0


@pytest.mark.parametrize(
    "wrong",
    [
        ["--workers", "0"],
        ["--memory", "lots"],
        ["--memory", "1M"],
        ["--timeout", "-3"],
        ["--timeout", "nan"],
        ["--exercise", "4.3"],
        ["--sandbox", "docker"],
        ["--sandbox", "sandlock", "--no-sandbox"],
        ["--scheduler", "tcp://127.0.0.1:9"],
        ["--tests", "/nowhere"],
        ["--only", "nobody"],
        ["--seed-file", "/nowhere"],
    ],
    ids=" ".join,
)
@pytest.mark.usefixtures("home")
def test_wrong_usage_is_told_in_a_line(tmp_path, wrong):
    (tmp_path / "in" / "ann").mkdir(parents=True)
    done = course("grade", tmp_path / "in", "--out", tmp_path / "out", *wrong)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert re.search(r"^course grade: .+", done.stderr, re.MULTILINE)


@pytest.mark.parametrize("text", ["1.5G", "1536M", "1536 MiB", "1.5gb", str(1536 * 2**20)])
def test_sizes(text):
    assert cli._bytes(text) == 1536 * 2**20


def test_the_usual_seed_file_is_made_once_for_its_owner_alone(home):
    path = seed_file.usual_path()
    assert path == home / "config" / "feature-matching" / "seed"
    assert seed_file.make(path)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    secret = seed_file.read(path)
    assert len(secret) >= 32
    assert not seed_file.make(path)
    assert seed_file.read(path) == secret
    assert [p.name for p in path.parent.iterdir()] == ["seed"]


def test_a_seed_file_that_others_will_see_is_refused(tmp_path):
    submissions, repository = tmp_path / "in", tmp_path / "repository"
    (submissions / "ann").mkdir(parents=True)
    (repository / ".git").mkdir(parents=True)
    (repository / "deep").mkdir()
    for folder, why in ((submissions / "ann", "lies in"), (repository / "deep", "git work tree")):
        (folder / "seed").write_bytes(b"x" * 32)
        for path in (folder / "seed", tmp_path / f"link-{why}"):
            if not path.exists():
                path.symlink_to(folder / "seed")
            with pytest.raises(seed_file.SeedFileError, match=why):
                seed_file.read(path, forbidden=[submissions])
            with pytest.raises(seed_file.SeedFileError, match=why):
                seed_file.make(path, forbidden=[submissions])


@pytest.mark.parametrize("content", [b"", b"short", b" " * 40, b"x" * 70_000])
def test_a_seed_file_that_holds_no_secret_is_refused(tmp_path, content):
    (tmp_path / "seed").write_bytes(content)
    with pytest.raises(seed_file.SeedFileError, match="16"):
        seed_file.read(tmp_path / "seed")


def test_a_seed_file_that_is_none_is_refused(tmp_path):
    with pytest.raises(seed_file.SeedFileError, match="no seed file"):
        seed_file.read(tmp_path / "seed")
    with pytest.raises(seed_file.SeedFileError, match="cannot be read"):
        seed_file.read(tmp_path)


def test_seeds_are_the_same_on_every_machine():
    assert Seeds(b"0123456789abcdef")("unseen", "tilt") == 2674516144
    assert Seeds(b"0123456789abcdef")("unseen", "tilt ") != 2674516144


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    (tmp_path / "hidden").mkdir()
    (tmp_path / "hidden" / "test_4_1.py").write_text("x = 1")
    return Settings(b"0123456789abcdef", tmp_path / "hidden", ("4.1",), "bubblewrap", Limits())


def test_a_fingerprint_changes_with_everything_that_matters(tmp_path, settings):
    own = tmp_path / "ann"
    (own / "sub").mkdir(parents=True)
    (own / "a.ipynb").write_text("1")
    (own / "sub" / "node.py").write_text("2")

    def now(**changed: object) -> str:
        return Fingerprints(replace(settings, **changed))([own])

    first = now()
    assert re.fullmatch("[0-9a-f]{32}", first)
    assert now() == first
    seen = [
        first,
        now(seed=b"0123456789abcdeF"),
        now(exercises=("4.1", "4.2")),
        now(sandbox="sandlock"),
        now(limits=Limits(call_s=3)),
    ]
    (own / "a.ipynb").write_text("3")
    seen.append(now())
    (own / "sub" / "node.py").chmod(0o755)
    seen.append(now())
    (own / "a.ipynb").rename(own / "b.ipynb")
    seen.append(now())
    (own / "link").symlink_to("b.ipynb")
    seen.append(now())
    (own / "link").unlink()
    (own / "link").symlink_to("c.ipynb")
    seen.append(now())
    (own / "empty").mkdir()
    seen.append(now())
    (settings.tests / "test_4_1.py").write_text("x = 2")
    seen.append(now())
    assert len(set(seen)) == len(seen)
    (settings.tests / "__pycache__").mkdir()
    (settings.tests / "__pycache__" / "x.pyc").write_bytes(b"x")
    assert now() == seen[-1]


def test_a_fingerprint_follows_nothing_and_waits_for_nothing(tmp_path, settings):
    own = tmp_path / "ann"
    own.mkdir()
    os.mkfifo(own / "pipe")
    (own / "loop").symlink_to(".")
    (own / "away").symlink_to("/etc")
    with (own / "huge").open("wb") as file:
        file.truncate(1 << 40)
    (own / os.fsdecode(b"\xff\xfe")).write_text("x")
    deep = own
    for _ in range(100):
        deep = deep / "d"
        deep.mkdir()
    start = time.monotonic()
    first = Fingerprints(settings)([own])
    assert time.monotonic() - start < 60  # reading it all would take far longer
    (tmp_path / "ann.zip").write_bytes(b"PK")
    assert Fingerprints(settings)([own, tmp_path / "ann.zip"]) != first
    assert Fingerprints(settings)([tmp_path / "missing"]) != first


def test_results_and_settings_survive_their_travels(settings):
    odd = os.fsdecode(b"\xff <b>\x1b[31m")
    result = SubmissionResult(
        odd,
        (TestResult("n", "4.1.1", 0.5, 1.0, odd, "partial", seconds=0.2),),
        notes=(odd,),
        events=("e",),
        pictures=(Picture("p", b"\x89PNG"), Picture("q", b"")),
        scenes=(Picture("s", b"\xff\xd8"),),
        code={"4.1": frozenset({1, 2**31}), "4.2": frozenset()},
        fingerprint="f",
        seconds=1.5,
    )
    data, blobs = framing.unpack(framing.pack(*to_message(result)))
    assert from_message(data, blobs) == result
    assert Settings.from_data(framing.unpack(framing.pack(settings.to_data()))[0]) == settings
    task = Task(odd, (Path(odd), Path("b")), "f", "why")
    assert Task.from_data(framing.unpack(framing.pack(task.to_data()))[0]) == task
    assert settings.seed.decode() not in repr(settings)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\0" * 7,
        framing.pack({"a": 1}, [b"xyz"])[:-1],
        framing.pack({"a": 1}) + b"x",
        b"\xff" * 8,
        b"\0\0\0\2\0\0\0\0[]",
        b"\0\0\0\1\0\0\0\0{",
        b"\0\1\0\0\0\0\0\0" + b'{"a":' + b"[" * 65531,
    ],
    ids=repr,
)
def test_what_is_no_message_is_told_apart(data):
    with pytest.raises(framing.BrokenMessageError):
        framing.unpack(data)


def shown(result: SubmissionResult, *, verbose: bool, failure: str = "") -> str:
    console = Console(width=300, force_terminal=False, highlight=False, record=True)
    progress = Shown(console, verbose=verbose)
    progress.start(3, Outcome(unchanged=["x", "y"]))
    progress.started(result.student)
    progress.finished(Finished(result, failure))
    progress.stop()
    return console.export_text()


def test_progress_in_plain_lines():
    test = TestResult("n", "4.1.1", 1.5, 2.0, "", "partial")
    result = SubmissionResult("[red]ann\x1b[31m\n", (test,), events=("memory limit of 2 GiB",))
    text = shown(result, verbose=False)
    assert "2 unchanged" in text
    assert re.search(r"^1/3  \[red\]ann  \d+\.\d s  about \d+ s left$", text, re.MULTILINE)
    assert "1.5" not in re.sub(r"\d+\.\d s", "", text)
    assert "1.5 of 2 points  memory limit of 2 GiB" in shown(result, verbose=True)
    lost = replace(result, tests=(replace(test, status="not_checked"),))
    assert "not checked: it broke" in shown(lost, verbose=False, failure="it broke")


def test_a_run_that_nobody_reads_goes_on():
    """`course grade … 2>&1 | head` is no reason to stop grading, nor is a full disk."""
    reading, writing = os.pipe()
    os.close(reading)
    full = os.open("/dev/full", os.O_WRONLY)
    for target in (os.fdopen(writing, "w"), os.fdopen(full, "w")):
        progress = Shown(_Console(file=target))
        progress.start(1, Outcome(unchanged=["x"]))
        progress.started("ann")
        progress.finished(Finished(SubmissionResult("ann", ())))
        progress.stop()
        with suppress(OSError):
            target.close()


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0, "1 s"), (59.5, "60 s"), (90, "2 min"), (180, "3 min"), (5400, "1 h 30 min")],
)
def test_times_for_people(seconds, text):
    assert for_people(seconds) == text
