"""What a submission's code can reach, and what is left of it: under both sandboxes, for real."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from queue import Empty

import pytest

import course_lib
from course_lib.grading.sandbox import (
    Launcher,
    NoSandboxError,
    SandboxedKernel,
    choose,
)
from course_lib.grading.sandbox import (
    choice as module,
)
from course_lib.grading.sandbox.processes import descendants as all_below
from course_lib.grading.scratch import remove

ROOT = Path(course_lib.__file__).resolve().parents[1]


def run(kernel: SandboxedKernel, code: str, timeout: float = 20) -> str:
    """Execute code; give what it printed, and how it failed."""
    said: list[str] = []

    def hear(message: dict) -> None:
        content = message["content"]
        kind = message["msg_type"]
        if kind == "stream":
            said.append(content["text"])
        elif kind == "error":
            said.append(f"{content['ename']}: {content['evalue']}")

    reply = kernel.client.execute_interactive(code, output_hook=hear, timeout=timeout)
    assert reply["content"]["status"] in {"ok", "error"}
    return "".join(said).strip()


def test_it_computes_with_the_course(launcher: Launcher, folder: Path) -> None:
    with launcher.kernel(folder) as kernel:
        code = "import cv2; from course_lib import images; print(images.load('ROS.png').shape)"
        assert run(kernel, code) == "(900, 600, 3)"


def test_it_writes_its_own_folder_and_reads_its_files(launcher: Launcher, folder: Path) -> None:
    (folder / "given.txt").write_text("given")
    with launcher.kernel(folder) as kernel:
        assert (
            run(kernel, "print(open('given.txt').read(), open('new.txt', 'w').write('xyz'))")
            == "given 3"
        )
    assert (folder / "new.txt").read_text() == "xyz"


@pytest.mark.parametrize(
    "path",
    [
        ROOT / "tests",
        ROOT / "solutions",
        ROOT / "images" / "heldout" / "mug_1.png",
        ROOT / "course_lib" / "grading" / "session.py",
        Path("/etc/shadow"),
        Path("/proc/1/environ"),
        Path("/root"),
        Path("/run"),
    ],
    ids=str,
)
def test_it_cannot_read(launcher: Launcher, folder: Path, path: Path) -> None:
    code = f"""
import os
path = {str(path)!r}
try:
    found = os.listdir(path) if os.path.isdir(path) else open(path, "rb").read()
    # As root the interpreter itself may live below /root: that, and nothing else, is there.
    print("read", [f for f in found if f != ".pyenv"] if path == "/root" else found)
except OSError as error:
    print("refused")
"""
    with launcher.kernel(folder) as kernel:
        assert run(kernel, code) in {"refused", "read []", "read b''"}


@pytest.mark.parametrize(
    "path", ["/usr/x", f"{ROOT}/course_lib/x", f"{sys.prefix}/x", "/x", "/etc/x"]
)
def test_it_cannot_write(launcher: Launcher, folder: Path, path: str) -> None:
    with launcher.kernel(folder) as kernel:
        assert "Error" in run(kernel, f"open({path!r}, 'w').write('x')")
    assert not Path(path).exists()


def test_it_sees_no_network(launcher: Launcher, folder: Path, tmp_path: Path) -> None:
    server = subprocess.Popen(
        [sys.executable, "-m", "http.server", "0", "--bind", "127.0.0.1", "-d", str(tmp_path)],
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    port = int(server.stdout.readline().split()[5])
    code = f"""
import socket
for address in [("127.0.0.1", {port}), ("192.0.2.1", 80)]:
    try:
        socket.create_connection(address, timeout=2)
        print("connected", address)
    except OSError:
        pass
try:
    socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b"x", ("192.0.2.1", 53))
    print("sent")
except OSError:
    pass
"""
    try:
        with launcher.kernel(folder) as kernel:
            assert run(kernel, code) == ""
    finally:
        server.kill()
        server.communicate()


def test_it_has_no_sockets_that_no_container_holds(launcher: Launcher, folder: Path) -> None:
    code = """
import socket
got = []
for family in set(range(1, 60)) - {1, 2, 10, 16}:
    for kind in (1, 2, 3, 5):
        try:
            socket.socket(family, kind)
            got.append((family, kind))
        except OSError as error:
            assert error.errno == 97, error
print(got)
"""
    with launcher.kernel(folder) as kernel:
        assert run(kernel, code) == "[]"


def test_it_cannot_gain_powers(launcher: Launcher, folder: Path) -> None:
    code = """
import ctypes
libc = ctypes.CDLL(None, use_errno=True)
status = dict(line.split(":\\t", 1) for line in open("/proc/self/status") if ":\\t" in line)
print([status[k].strip() for k in ("CapEff", "CapPrm", "CapBnd", "NoNewPrivs", "Seccomp")])
print(libc.unshare(0x10000000), libc.ptrace(0, 0, 0, 0), libc.mount(b"a", b"/tmp", b"tmpfs", 0, 0))
"""
    with launcher.kernel(folder) as kernel:
        found = run(kernel, code).splitlines()
    assert found[0] == "['0000000000000000', '0000000000000000', '0000000000000000', '1', '2']"
    assert found[1] == "-1 -1 -1"


def test_it_cannot_signal_others(launcher: Launcher, folder: Path) -> None:
    outsider = subprocess.Popen(["sleep", "60"])
    code = f"""
import os
for pid in ({outsider.pid}, {os.getpid()}):
    try:
        os.kill(pid, 9)
        print("killed", pid)
    except OSError:
        pass
"""
    try:
        with launcher.kernel(folder) as kernel:
            run(kernel, code)
        assert outsider.poll() is None
    finally:
        outsider.kill()
        outsider.wait()


LIMITS = {
    "memory": ("x = [bytearray(50_000_000) for _ in range(200)]", None),
    "memory of children": (
        (
            "import os, time\n"
            "for _ in range(6):\n"
            "    if os.fork() == 0:\n"
            "        x = bytearray(b'1' * 300_000_000); time.sleep(200)\n"
            "time.sleep(200)"
        ),
        "memory limit",
    ),
    "forks": ("import os\nwhile True:\n    os.fork()", None),
    "processor": (
        (
            "import os\nfor _ in range(4):\n    if os.fork() == 0:\n        while True: pass\n"
            "while True: pass"
        ),
        "processor limit",
    ),
    "disk": (
        (
            "for i in range(40):\n    open(f'{i}', 'wb').write(b'1' * 4_000_000)\n"
            "import time; time.sleep(200)"
        ),
        "disk limit",
    ),
}


@pytest.mark.parametrize("name", LIMITS)
def test_a_limit_ends_it_and_is_named(launcher: Launcher, folder: Path, name: str) -> None:
    code, event = LIMITS[name]
    with launcher.kernel(folder) as kernel:
        kernel.client.execute(code)
        # On a busy machine a few seconds of the processor take long: the others go first.
        deadline = time.monotonic() + 240
        while kernel.is_alive() and time.monotonic() < deadline:
            with contextlib.suppress(Empty):
                kernel.client.get_shell_msg(timeout=0.1)
                break
        events = list(kernel.events)
    assert event is None or any(event in found for found in events), events
    remove(folder)  # what fills it would end the next kernel, too
    folder.mkdir()
    assert run_after(launcher, folder) == "2"


def test_a_fork_bomb_stays_small(launcher: Launcher, folder: Path) -> None:
    before = set(all_below(os.getpid()))
    with launcher.kernel(folder) as kernel:
        bomb = "import os\nwhile True:\n    try: os.fork()\n    except OSError: pass"
        kernel.client.execute(bomb)
        end, most = time.monotonic() + 2, 0
        while time.monotonic() < end:
            most = max(most, len(all_below(os.getpid())) - len(before))
    assert most > 10, "it went off"
    assert most < 2 * launcher.limits.processes
    assert set(all_below(os.getpid())) <= before
    assert run_after(launcher, folder) == "2"


def test_nothing_is_left_at_once(launcher: Launcher, folder: Path) -> None:
    before = set(all_below(os.getpid()))
    for _ in range(10):  # who held the mounts used to be there for some milliseconds more
        assert run_after(launcher, folder) == "2"
        assert set(all_below(os.getpid())) <= before


def run_after(launcher: Launcher, folder: Path) -> str:
    with launcher.kernel(folder) as kernel:
        return run(kernel, "print(1 + 1)")


def processes_with(marker: str) -> list[int]:
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if marker.encode() in path.read_bytes():
                found.append(int(path.parent.name))
        except OSError:
            continue
    return found


def test_a_daemon_is_gone_when_the_kernel_is_closed(launcher: Launcher, folder: Path) -> None:
    marker = f"987{os.getpid()}"
    code = f"""
import os, signal, subprocess
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        for number in range(1, 65):
            try: signal.signal(number, signal.SIG_IGN)
            except (OSError, ValueError): pass
        subprocess.Popen(["sleep", "{marker}"], start_new_session=True)
        os.execvp("sleep", ["sleep", "{marker}"])
    os._exit(0)
import time; time.sleep(1)
"""
    with launcher.kernel(folder) as kernel:
        run(kernel, code)
        assert processes_with(marker)
    assert not processes_with(marker)


def test_an_interrupt_stops_a_cell(launcher: Launcher, folder: Path) -> None:
    with launcher.kernel(folder) as kernel:
        request = kernel.client.execute("import time\nwhile True: time.sleep(0.1)")
        time.sleep(0.5)
        kernel.interrupt()
        reply = kernel.client.get_shell_msg(timeout=10)
        assert reply["parent_header"]["msg_id"] == request
        assert reply["content"]["ename"] == "KeyboardInterrupt"


def left_open() -> tuple[int, int]:
    sockets = Path(tempfile.gettempdir()).glob("k-*")
    return len(list(Path("/proc/self/fd").iterdir())), len(list(sockets))


def test_nothing_is_left_open_after_many_kernels(launcher: Launcher, folder: Path) -> None:
    with launcher.kernel(folder) as kernel:
        run(kernel, "1")
    before = left_open()
    for _ in range(5):
        with launcher.kernel(folder) as kernel:
            run(kernel, "1")
    assert left_open() == before


def test_a_dead_kernel_is_noticed(launcher: Launcher, folder: Path) -> None:
    with launcher.kernel(folder) as kernel:
        kernel.client.execute("import os; os._exit(3)")
        deadline = time.monotonic() + 10
        while kernel.is_alive() and time.monotonic() < deadline:
            time.sleep(0.02)
        assert not kernel.is_alive()


AS_USER = """
mount -t tmpfs tmpfs /mnt
mkdir -p /mnt/site-packages /mnt/repo /mnt/tmp
chmod 1777 /mnt/tmp
mount --bind {packages} /mnt/site-packages
mount --bind {root} /mnt/repo
cd /mnt/tmp
export HOME=/mnt/tmp TMPDIR=/mnt/tmp PYTHONPATH=/mnt/repo:/mnt/site-packages
exec setpriv --reuid 1000 --regid 1000 --clear-groups {python} -c "$1"
"""
USER_CODE = """
import os, tempfile
from pathlib import Path
from course_lib.grading.sandbox import Launcher
with Launcher("{sandbox}") as launcher, launcher.kernel(Path(tempfile.mkdtemp())) as kernel:
    kernel.client.execute_interactive(
        "import os, cv2; open('x', 'w').write('1');"
        "print('here', os.access('/etc/shadow', os.R_OK), os.path.exists('/mnt/repo/tests'))",
        timeout=20,
    )
print("user", os.getuid())
"""
# The student's processes run under the instructor's own user id, who may lock or lease any of it.
MEDDLING = """
import fcntl, os
outside = {outside!r}
def may(do, *args, **options):
    try:
        do(*args, **options)
    except OSError:
        return False
    return True
own = os.open("own", os.O_RDONLY | os.O_CREAT)
os.symlink(outside, "link")
os.mkdir("folder")
there = os.open("folder", os.O_RDONLY)
print(
    "meddled",
    may(os.chmod, outside, 0),
    may(os.chmod, os.path.dirname(outside), 0),
    may(os.chmod, "link", 0),
    may(os.chmod, os.path.join("..", os.path.basename(os.path.dirname(outside))), 0),
    may(os.utime, outside, (0, 0)),
    may(os.utime, "link"),
    may(os.chown, outside, -1, os.getgid()),
    may(os.setxattr, outside, "user.x", b""),
    may(fcntl.fcntl, own, fcntl.F_SETLEASE, fcntl.F_WRLCK),
)
os.chmod("own", 0o750)
assert os.stat("own").st_mode & 0o777 == 0o750
os.fchmod(own, 0o741)
os.utime("own", ns=(1, 2))
assert os.stat("own").st_mtime_ns == 2
os.utime(own)
open("folder/own", "w").close()
os.chmod("own", 0o711, dir_fd=os.open(".", os.O_RDONLY))
os.utime("link", (3, 3), follow_symlinks=False)
os.chmod("folder/own", 0o700)
os.chmod("own", 0o4755)
print("own", oct(os.stat("own").st_mode), os.stat("own").st_mtime > 9, os.lstat("link").st_mtime)
for wrong in ("", "none", "x" * 5000, "own/own"):
    assert not may(os.chmod, wrong, 0)
"""
MEDDLER_CODE = """
import os, tempfile
from pathlib import Path
from course_lib.grading.sandbox import Launcher
outside = Path(tempfile.mkdtemp()) / "results"
outside.write_text("")
code = {code!r}.replace("{{outside!r}}", repr(str(outside)))
before = [os.stat(path) for path in (outside, outside.parent)]
with Launcher("{sandbox}") as launcher, launcher.kernel(Path(tempfile.mkdtemp())) as kernel:
    kernel.client.execute_interactive(code, timeout=40)
assert [os.stat(path) for path in (outside, outside.parent)] == before
"""


def run_as_user(code: str) -> subprocess.CompletedProcess[str]:
    packages = Path(pytest.__file__).resolve().parents[1]
    script = AS_USER.format(packages=packages, root=ROOT, python="/usr/bin/python3")
    if os.getuid() == 0:
        command = ["unshare", "-m", "--propagation", "private", "bash", "-ec", script, "x", code]
    else:
        command = [sys.executable, "-c", code]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


@pytest.mark.parametrize("sandbox", ["bubblewrap", "sandlock"])
def test_an_ordinary_user_can_grade(sandbox: str) -> None:
    done = run_as_user(USER_CODE.format(sandbox=sandbox))
    assert "here False" in done.stdout, done.stderr
    assert "user 0" not in done.stdout


@pytest.mark.parametrize("sandbox", ["bubblewrap", "sandlock"])
def test_what_the_user_owns_is_not_the_students_to_lock(sandbox: str) -> None:
    done = run_as_user(MEDDLER_CODE.format(sandbox=sandbox, code=MEDDLING))
    assert f"meddled{' False' * 9}\n" in done.stdout, done.stdout + done.stderr
    mode = "0o104755" if sandbox == "bubblewrap" else "0o100755"
    assert f"own {mode} True 3.0\n" in done.stdout
    assert done.returncode == 0, done.stdout + done.stderr


def test_choosing_says_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module.bubblewrap, "complaint", lambda: "bubblewrap is not installed")
    assert choose() == "sandlock"
    monkeypatch.setattr(module, "_sandlock_complaint", lambda: "sandlock is not installed")
    with pytest.raises(NoSandboxError, match="apt install bubblewrap"):
        choose()
    with pytest.raises(ValueError, match="chroot"):
        choose("chroot")


def test_killing_the_grader_ends_the_sandbox(folder: Path) -> None:
    marker = f"986{os.getpid()}"
    code = f"""
import sys, time
from pathlib import Path
from course_lib.grading.sandbox import Launcher
with Launcher(sys.argv[1]) as launcher, launcher.kernel(Path({str(folder)!r})) as kernel:
    kernel.client.execute("import subprocess; subprocess.Popen(['sleep', '{marker}'])")
    time.sleep(2)
    print("up", flush=True)
    time.sleep(60)
"""
    for sandbox in ("bubblewrap", "sandlock"):
        grader = subprocess.Popen(
            [sys.executable, "-c", code, sandbox],
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )
        assert grader.stdout.readline() == b"up\n"
        assert processes_with(marker)
        grader.send_signal(signal.SIGKILL)
        grader.communicate()
        deadline = time.monotonic() + 10
        while processes_with(marker) and time.monotonic() < deadline:
            time.sleep(0.05)
        assert not processes_with(marker)


@pytest.mark.parametrize("sandbox", ["bubblewrap", "sandlock"])
def test_a_kernel_leaves_no_dead_process_to_be_buried(sandbox: str, folder: Path) -> None:
    # A container ends when all its dead are buried: until then everybody would wait for it.
    code = f"""
from pathlib import Path
from course_lib.grading.sandbox import Launcher, confine
confine.become_subreaper()  # as a worker is
with Launcher({sandbox!r}) as launcher:
    with launcher.kernel(Path({str(folder)!r})) as kernel:
        kernel.client.execute_interactive("1;", timeout=60)
    print(Path("/proc", str(kernel._box._pid)).exists())
"""
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)
    assert said.stdout == "False\n"
