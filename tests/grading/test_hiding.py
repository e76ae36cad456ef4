"""What a process or a file may do to be overlooked, and is not."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.grading.intake.streams import Limited, TooLargeError
from course_lib.grading.sandbox import places, processes
from course_lib.grading.sandbox.watcher import _usage
from course_lib.grading.scratch import remove


def descend(folder: Path, depth: int) -> None:
    """Make folders in each other, deeper than a path can say."""
    code = "import os, sys\nos.chdir(sys.argv[1])\n"
    code += "for _ in range(int(sys.argv[2])):\n    os.mkdir('d'); os.chdir('d')\nopen('x', 'w')"
    subprocess.run([sys.executable, "-c", code, folder, str(depth)], check=True)


def test_folders_of_any_depth_are_removed(tmp_path):
    folder = tmp_path / "deep"
    folder.mkdir()
    descend(folder, 3000)
    remove(folder)
    assert not folder.exists()


def test_a_folder_is_removed_whatever_its_permissions_and_links_are_not_followed(tmp_path):
    kept, folder = tmp_path / "kept", tmp_path / "folder"
    kept.mkdir()
    (kept / "file").touch()
    (folder / "a" / "b" / ".removed-0").mkdir(parents=True)
    (folder / ".removed-0").mkdir()
    (folder / "a" / "link").symlink_to(kept)
    (folder / "loop").symlink_to("loop")
    os.mkfifo(folder / "a" / "b" / "pipe")
    for path in (folder / "a" / "b", folder / "a", folder):
        path.chmod(0)
    remove(folder)
    remove(folder)
    assert not folder.exists()
    assert (kept / "file").exists()


def test_the_disk_watch_sees_folders_and_gives_up_on_deep_ones(tmp_path):
    (tmp_path / "wide").mkdir()
    for number in range(30):
        (tmp_path / "wide" / str(number)).mkdir()
    assert _usage(tmp_path / "wide", 1000)[1:] == (30, False)
    assert _usage(tmp_path / "wide", 10)[1] == 10
    descend(tmp_path, 200)
    assert _usage(tmp_path, 1000)[2]


def strange_name() -> None:
    ctypes.CDLL(None).prctl(15, b"\xff) Z 1 (\n", 0, 0, 0)
    time.sleep(60)


def no_head() -> None:
    threading.Thread(target=time.sleep, args=(60,)).start()
    ctypes.CDLL(None).syscall({"x86_64": 60, "aarch64": 93}[os.uname().machine], 0)


@pytest.mark.parametrize("being", [strange_name, no_head])
def test_a_process_is_found_whatever_it_looks_like(being: Callable[[], None]):
    child = os.fork()
    if child == 0:
        being()
        os._exit(0)
    try:
        time.sleep(0.5)
        assert child in processes.descendants(os.getpid())
        assert processes.parent(child) == os.getpid()
        assert processes.memory(child)[0] > 1_000_000
        assert processes.share_of_memory(child)
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    assert child not in processes.descendants(os.getpid())


def test_a_course_within_the_system_stays_hidden(tmp_path, monkeypatch):
    course = tmp_path / "usr" / "src" / "course"
    for name in ("course_lib", "tests", "solutions"):
        (course / name).mkdir(parents=True)
    (tmp_path / "usr" / "lib").mkdir()
    (tmp_path / "usr" / "src" / "way_in").symlink_to(course)
    monkeypatch.setattr(places, "COURSE", course / "course_lib")
    monkeypatch.setattr(places, "_SYSTEM", (str(tmp_path / "usr"),))
    seen = [path for path in places.readable() if path.is_relative_to(tmp_path)]
    assert seen == [tmp_path / "usr" / "lib"]
    assert places.seen_by_students(tmp_path / "usr" / "lib" / "x") == tmp_path / "usr" / "lib"
    assert places.seen_by_students(course / "tests") is None


def test_a_stream_is_read_so_far_and_no_further(tmp_path):
    (tmp_path / "x").write_bytes(bytes(100))
    with (tmp_path / "x").open("rb") as file:
        limited = Limited(file, most=50)
        assert limited.read(20) == bytes(20)
        assert limited.seek(40) == 40
        with pytest.raises(TooLargeError):
            limited.seek(60)
