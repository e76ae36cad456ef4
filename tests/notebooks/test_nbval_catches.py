"""nbval, as `make test` calls it, fails on a changed result and passes on the same."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook, new_output

SANITIZE = Path(__file__).with_name("sanitize.cfg")


def run_nbval(folder: Path, stored: str, source: str = "print(6 * 7)") -> int:
    output = new_output("stream", name="stdout", text=stored)
    cell = new_code_cell(source, execution_count=1, outputs=[output])
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    nbformat.write(
        new_notebook(cells=[cell], metadata={"kernelspec": kernel}), folder / "one.ipynb"
    )
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--nbval"]
    command += ["--nbval-sanitize-with", str(SANITIZE), "--rootdir", str(folder), str(folder)]
    return subprocess.run(command, cwd=folder, check=False, capture_output=True).returncode


def test_same_result_passes(tmp_path: Path) -> None:
    assert run_nbval(tmp_path, "42\n") == pytest.ExitCode.OK


def test_changed_result_fails(tmp_path: Path) -> None:
    assert run_nbval(tmp_path, "41\n") == pytest.ExitCode.TESTS_FAILED


def test_addresses_are_overlooked_but_sizes_are_not(tmp_path: Path) -> None:
    source = "print('at 0x1f', '640x480')"
    assert run_nbval(tmp_path, "at 0x2e 640x480\n", source) == pytest.ExitCode.OK
    assert run_nbval(tmp_path, "at 0x2e 641x480\n", source) == pytest.ExitCode.TESTS_FAILED
