"""The command line, and what remains after an interrupt."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from synthetic_bag import NODES

import course_lib
from course_lib.offline_ros import Recording


def command(*arguments: object, **options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "course_lib.offline_ros", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
        **options,
    )


def test_command_records_what_can_be_read_back(bag: Path, tmp_path: Path) -> None:
    done = command(
        NODES / "subscriber.py", "turned:=/a", "--bag", bag, "--record", tmp_path, "--max-frames=5"
    )
    assert done.returncode == 0
    assert "[INFO]" in done.stdout
    assert "5 pictures" in done.stderr
    assert "/a 5" in done.stderr
    recording = Recording(tmp_path / "subscriber.bag")
    assert len(recording["/a"]) == 5
    assert len(Recording(recording.save(tmp_path / "copy.bag"))["/a"]) == 5
    with pytest.raises(KeyError, match=r"did not publish /b; it published /a, "):
        recording["/b"]


def test_command_tells_wrong_usage(bag: Path) -> None:
    assert command("none.py").returncode == 2
    assert (
        "'-1' is not a positive number"
        in command(NODES / "talker.py", "--bag", bag, "--rate=-1").stderr
    )
    assert "overwrite" in command(NODES / "talker.py", "--bag", bag, "--record", bag).stderr
    assert "_param:=value" in command("--help").stdout
    crashed = command(NODES / "crash.py", "--bag", bag)
    assert crashed.returncode == 1
    assert "third picture is too much" in crashed.stderr


def test_a_traceback_holds_the_nodes_own_lines_where_the_course_is_linked_to(
    bag: Path, tmp_path: Path
) -> None:
    course = Path(course_lib.__file__).parent
    (tmp_path / "linked" / course.name).mkdir(parents=True)
    for part in course.iterdir():
        (tmp_path / "linked" / course.name / part.name).symlink_to(part)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "linked")}
    crashed = command(
        NODES / "crash.py", "--bag", bag, "--quiet", env=environment, cwd=tmp_path / "linked"
    )
    assert "third picture is too much" in crashed.stderr
    assert "offline_ros" not in crashed.stderr


def test_interrupt_runs_the_hooks_and_leaves_nothing_behind(bag: Path, tmp_path: Path) -> None:
    node = tmp_path / "node.py"
    node.write_text(
        "import rospy\nfrom sensor_msgs.msg import CameraInfo\nrospy.init_node('n')\n"
        "rospy.on_shutdown(lambda: print('hook', flush=True))\n"
        "ready = lambda message: print('ready', flush=True)\n"
        "rospy.Subscriber('/camera/rgb/camera_info', CameraInfo, ready)\n"
        "rospy.spin()\nprint('after', flush=True)\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-m", "course_lib.offline_ros", node, "--bag", bag, "--rate=1"],
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        process.send_signal(2)
        assert process.stdout.readline() == "hook\n"
        assert process.stdout.readline() == "after\n"
        assert process.wait(10) == 130
    finally:
        process.kill()
        process.wait()


def test_interrupting_run_node_ends_the_node_and_its_children(bag: Path, tmp_path: Path) -> None:
    pids = tmp_path / "pids"
    node = tmp_path / "node.py"
    node.write_text(
        "import os, rospy, subprocess\nchild = subprocess.Popen(['sleep', '300'])\n"
        f"open({str(pids)!r}, 'w').write(f'{{os.getpid()}} {{child.pid}} .')\n"
        "rospy.init_node('n')\nrospy.spin()\n"
    )
    script = tmp_path / "notebook.py"
    script.write_text(
        "from course_lib.offline_ros import run_node\n"
        f"run_node({str(node)!r}, bag={str(bag)!r}, rate=0.1)\n"
    )
    notebook = subprocess.Popen([sys.executable, script], stderr=subprocess.DEVNULL)
    try:
        _until(lambda: pids.exists() and pids.read_text().endswith("."))
        running = [int(pid) for pid in pids.read_text().split()[:2]]
        notebook.send_signal(2)
        notebook.wait(20)
        _until(lambda: not any(_runs(pid) for pid in running))
    finally:
        notebook.kill()
        notebook.wait()


def _runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def _until(condition, seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen in time"
        threading.Event().wait(0.05)


def test_a_terminal_gets_a_progress_bar_and_its_cursor_back(bag: Path) -> None:
    terminal, its_end = pty.openpty()
    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "course_lib.offline_ros",
            NODES / "window.py",
            "--bag",
            bag,
            "--rate=20",
        ],
        stdout=subprocess.DEVNULL,
        stderr=its_end,
    )
    os.close(its_end)
    shown = b""
    try:
        while part := _read(terminal):
            shown += part
        assert process.wait(20) == 0
    finally:
        process.kill()
        process.wait()
        os.close(terminal)
    assert b"/20" in shown
    assert shown.rpartition(b"\x1b[?25")[2].startswith(b"h")
    assert b"20 pictures in " in shown.splitlines()[-1]


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 4096)
    except OSError:  # Linux's way of saying that the other end is closed
        return b""
