"""
Notebooks run alone, headless, without network, and leave nothing behind.

How long they take is measured by `tests/bench/bench_notebooks.py`.
"""

from __future__ import annotations

import asyncio
import base64
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cv2
import nbformat
import numpy as np
import pytest
from nbformat.v4 import new_code_cell, new_notebook

from course_lib.publish.execute import main
from course_lib.publish.lint import lint_file
from course_lib.publish.normalise import WIDGET_VIEW, strip_png_notes
from course_lib.publish.runner import NotebookFailed, run_notebook

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))

PLOT = """
import io, base64, ipywidgets
from matplotlib.figure import Figure
file = io.BytesIO()
figure = Figure(); figure.subplots().plot([1, 2]); figure.savefig(file)
class Viewer(ipywidgets.VBox):
    def _repr_mimebundle_(self, **options):
        png = base64.b64encode(file.getvalue()).decode()
        return super()._repr_mimebundle_(**options) | {"image/png": png, "text/plain": "A line."}
Viewer()
"""


def write(path: Path, *sources: str) -> Path:
    cells = [new_code_cell(source.strip(), id=f"cell-{i}") for i, source in enumerate(sources)]
    nbformat.write(new_notebook(cells=cells), path)
    return path


def kernels() -> set[str]:
    """The offline kernels that this process or its children started."""
    command = ["pgrep", "-u", str(os.getuid()), "-f", "course_lib.publish.offline_kernel"]
    return set(subprocess.run(command, check=False, capture_output=True, text=True).stdout.split())


LOOK_BACK = """
import subprocess, sys, os
pyplot = sys.modules.get("matplotlib.pyplot")
assert not (pyplot and pyplot.get_fignums()), "open figures"
list_children = ["ps", "-o", "args=", "--ppid", str(os.getpid())]
children = subprocess.run(list_children, capture_output=True, text=True).stdout.splitlines()
assert [child for child in children if not child.startswith("ps ")] == [], children
"""


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs_alone_offline_and_leaves_nothing(path: Path, tmp_path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    notebook.cells.append(new_code_cell(LOOK_BACK))
    # A folder like the repository, so that relative paths hold and nothing is written into it.
    for part in ROOT.iterdir():
        if part.name != "notebooks" and not part.name.startswith("."):
            (tmp_path / part.name).symlink_to(part)
    (tmp_path / "notebooks").mkdir()
    copy = tmp_path / "notebooks" / path.name
    nbformat.write(notebook, copy)
    run_notebook(copy, cell_timeout=120)


def test_network_is_refused_by_name(tmp_path: Path) -> None:
    path = write(tmp_path / "a.ipynb", "import socket; socket.create_connection(('192.0.2.1', 80))")
    with pytest.raises(NotebookFailed, match=r"runs without network, but this cell wants"):
        run_notebook(path)


def test_programs_that_a_notebook_starts_have_no_network_either(tmp_path: Path) -> None:
    path = write(tmp_path / "a.ipynb", "print(open('/proc/self/net/dev').read())")
    probe = [sys.executable, "-c", "from course_lib.publish import offline_kernel as o\n"]
    probe[-1] += "raise SystemExit(not o.leave_network())"
    if subprocess.run(probe, check=False).returncode:
        pytest.skip("this system grants no network namespace")
    text = run_notebook(path).cells[0].outputs[0].text
    assert "lo:" in text
    assert len(text.split("\n", 2)[2].split(":")) == 2  # below two headings there is but lo


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("1 / 0", "a cell raised"),
        ("import os; os._exit(1)", "the kernel died"),
        ("import time; time.sleep(30)", "took longer than 1 s"),
    ],
)
def test_failure_names_the_notebook(tmp_path: Path, source: str, words: str) -> None:
    path = write(tmp_path / "wrong.ipynb", source)
    with pytest.raises(NotebookFailed, match=rf"wrong.ipynb: .*{words}"):
        run_notebook(path, cell_timeout=1)


def test_second_execution_changes_no_byte(tmp_path: Path) -> None:
    path = write(tmp_path / "a.ipynb", PLOT, "print(6 * 7)")
    assert main([str(path)]) == 0
    first = path.read_bytes()
    assert main([str(path)]) == 0
    assert path.read_bytes() == first
    assert main([str(path), "--check"]) == 0
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert "widgets" not in notebook.metadata
    data = notebook.cells[0].outputs[0].data
    assert {WIDGET_VIEW, "image/png", "text/plain"} <= set(data)
    assert b"Software" not in base64.b64decode(data["image/png"])


def test_printed_pieces_are_stored_as_one_text(tmp_path: Path) -> None:
    source = "import sys, time\nfor i in range(3):\n    print(i, flush=True); time.sleep(0.3)\n"
    source += "print('oh', file=sys.stderr)"
    outputs = run_notebook(write(tmp_path / "a.ipynb", source)).cells[0].outputs
    assert [(o.name, o.text) for o in outputs] == [("stdout", "0\n1\n2\n"), ("stderr", "oh\n")]


def test_stripped_png_keeps_its_pixels() -> None:
    pixels = np.random.default_rng(0).integers(0, 256, (7, 5, 3), np.uint8)
    png = cv2.imencode(".png", pixels)[1].tobytes()
    note = b"\0\0\0\4tEXtA\0bc\0\0\0\0"
    noted = png[:33] + note + png[33:]
    assert strip_png_notes(noted) == png
    assert strip_png_notes(b"no picture") == b"no picture"


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("print(object())", "at 0x"),
        ("import sys; print('careful', file=sys.stderr)", "stderr"),
        ("print('x' * 300_000)", "bytes"),
        ("import ipywidgets; ipywidgets.IntSlider()", "still picture"),
        ("import matplotlib.pyplot as p; p.plot([1]); p.show()", "alternative text"),
    ],
)
def test_bad_notebook_is_not_stored(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], source: str, words: str
) -> None:
    path = write(tmp_path / "a.ipynb", source)
    before = path.read_bytes()
    assert main([str(path)]) == 1
    assert words in capsys.readouterr().out
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("%matplotlib inline", "magic"),
        ("!ls", "shell command"),
        ("from ipywidgets import Output", "Output"),
        ("import ipywidgets as w\nw.interact(print, x=3);", "interact"),
        ("\n".join(["a = 1"] * 16), "lines of code"),
        ("a = 1", "never executed"),
    ],
)
def test_bad_source_is_found_without_a_run(tmp_path: Path, source: str, words: str) -> None:
    problems = lint_file(write(tmp_path / "a.ipynb", source))
    assert any(words in problem for problem in problems)


@pytest.mark.parametrize("wait", [0.8, 3.0])
def test_interrupt_leaves_no_kernel_and_no_change(tmp_path: Path, wait: float) -> None:
    path = write(tmp_path / "slow.ipynb", "import time; time.sleep(60)")
    before, others = path.read_bytes(), kernels()
    command = [sys.executable, "-m", "course_lib.publish.execute", str(path)]
    run = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    time.sleep(wait)  # while the kernel starts, and while the cell runs
    run.send_signal(signal.SIGINT)
    _, errors = run.communicate(timeout=20)
    assert run.returncode in {130, -signal.SIGINT}  # the latter: before Python had our code
    assert b"Traceback" not in errors or run.returncode < 0
    mine = {pid for pid in kernels() - others if str(path.parent).encode() in cwd_of(pid)}
    assert mine == set()
    assert path.read_bytes() == before


def cwd_of(pid: str) -> bytes:
    try:
        return os.fsencode(Path(f"/proc/{pid}/cwd").readlink())
    except OSError:
        return b""


def test_notebook_runs_where_an_event_loop_runs_already(tmp_path: Path) -> None:
    """As in a notebook's own cell, or after browser tests in the same process."""
    path = write(tmp_path / "a.ipynb", "print(6 * 7)")

    async def from_a_coroutine() -> str:
        return str(run_notebook(path).cells[0].outputs[0].text)

    # In a thread of its own: Playwright may have left a loop running in this one.
    with ThreadPoolExecutor(1) as thread:
        assert thread.submit(asyncio.run, from_a_coroutine()).result() == "42\n"
