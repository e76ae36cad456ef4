"""The progress bar of notebooks: one picture that fills up, and nothing elsewhere."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import nbformat
import numpy as np
import PIL.Image
from nbformat.v4 import new_code_cell, new_notebook

from course_lib.progress import FEW, HEIGHT, TEXT, WIDTH, bar_png, track
from course_lib.publish.lint import lint
from course_lib.publish.runner import run_notebook

if TYPE_CHECKING:
    from pathlib import Path

    import pytest


def filled(png: bytes) -> float:
    """The share of the bar that is coloured."""
    pixels = np.asarray(PIL.Image.open(io.BytesIO(png)).convert("RGB"))
    assert pixels.shape == (HEIGHT, WIDTH, 3)
    row = pixels[HEIGHT // 2, : WIDTH - TEXT - 10]
    return float((row == (0, 158, 115)).all(axis=1).mean())


def test_bar_is_as_full_as_the_work() -> None:
    shares = [filled(bar_png(share, "5 of 10 frames")) for share in (0.0, 0.25, 0.5, 1.0)]
    np.testing.assert_allclose(shares, [0.0, 0.25, 0.5, 1.0], atol=0.03)


def test_outside_a_notebook_nothing_is_shown(capsys: pytest.CaptureFixture[str]) -> None:
    assert list(track([7] * 20, "frames")) == [7] * 20
    assert capsys.readouterr() == ("", "")


def test_notebook_keeps_one_full_bar_that_satisfies_the_lint(tmp_path: Path) -> None:
    source = (
        "import time\nfrom course_lib.progress import track\n"
        f"print(sum(time.sleep(0.05) or n for n in track(range({FEW}), 'frames')))\n"
        f"print(sum(track(range({FEW - 1}))))"
    )
    path = tmp_path / "a.ipynb"
    nbformat.write(new_notebook(cells=[new_code_cell(source, id="bar")]), path)
    notebook = run_notebook(path)
    bar, *printed = notebook.cells[0].outputs
    assert [output.output_type for output in printed] == ["stream"]
    assert printed[0].text == "45\n36\n"
    assert bar.metadata["image/png"]["alt"] == f"{FEW} of {FEW} frames"
    # nbval compares a new run's first message with this stored last one.
    assert bar.data["text/plain"] == f"{FEW} frames"
    assert lint(notebook) == []
