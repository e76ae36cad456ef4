"""An export that would be incomplete is refused, and says why."""

from __future__ import annotations

from pathlib import Path

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from course_lib.publish.markdown import formula
from course_lib.publish.page import Exporter
from course_lib.publish.site import build, main


def page(folder: Path, *cells: object) -> str:
    path = folder / "a.ipynb"
    exporter = Exporter({path.resolve(): "a.html"})
    return exporter.export(path, new_notebook(cells=list(cells))).body


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("![](square.png)", "no alternative text"),
        ('<img src="square.png">', "no alternative text"),
        ("![A square](missing.png)", "not a file"),
        ("[next](missing.ipynb)", "not a file"),
        ("![A square](https://example.org/a.png)", "network"),
        ('<script src="//example.org/a.js"></script>', "network"),
        (r"$\nosuchthing{a}$", "nosuchthing is not understood"),
    ],
)
def test_faulty_markdown_is_refused(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "square.png").write_bytes(b"")
    with pytest.raises(ValueError, match=rf"a.ipynb.*{words}"):
        page(tmp_path, new_markdown_cell(text))


def test_link_to_a_page_on_the_web_is_kept(tmp_path: Path) -> None:
    html = page(tmp_path, new_markdown_cell("[paper](https://example.org/orb.pdf)"))
    assert 'href="https://example.org/orb.pdf"' in html


def test_text_output_is_never_markup(tmp_path: Path) -> None:
    output = {"output_type": "stream", "name": "stdout", "text": "<script>alert(1)</script>"}
    html = page(tmp_path, new_code_cell("print()", outputs=[nbformat.from_dict(output)]))
    assert "<script>" not in html


def test_widget_that_no_page_can_show_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.ipynb"
    nbformat.write(
        new_notebook(cells=[new_code_cell("import ipywidgets; ipywidgets.Accordion()")]), path
    )
    with pytest.raises(ValueError, match=r"a.ipynb: .*cannot show the widget Accordion"):
        build([path], tmp_path / "site")
    assert not (tmp_path / "site").exists()


def test_folder_of_somebody_else_is_left_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    nbformat.write(new_notebook(cells=[new_markdown_cell("# A")]), tmp_path / "a.ipynb")
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "thesis.txt").write_text("years of work")
    assert main([str(tmp_path / "a.ipynb"), "--out", str(tmp_path / "home")]) == 1
    assert "no exported course" in capsys.readouterr().err
    assert (tmp_path / "home" / "thesis.txt").read_text() == "years of work"


def test_second_export_replaces_the_first(tmp_path: Path) -> None:
    for name in ("old", "new"):
        nbformat.write(new_notebook(cells=[new_markdown_cell("# A")]), tmp_path / f"{name}.ipynb")
        build([tmp_path / f"{name}.ipynb"], tmp_path / "site")
    assert [p.name for p in (tmp_path / "site").glob("*.html")] == ["new.html"]


@pytest.mark.parametrize(
    ("latex", "mathml"),
    [
        (r"\operatorname{atan2}(y, x)", "<mtext>atan2</mtext>"),
        (r"\begin{aligned} a &= b \\ c &= d \end{aligned}", "<mtable"),
        (r"\tau = \begin{cases} 1 & p < q \\ 0 & \text{otherwise} \end{cases}", "<mtable"),
        (r"\frac{m_{10}}{m_{00}}", "<mfrac>"),
    ],
)
def test_formula_is_understood(latex: str, mathml: str) -> None:
    assert mathml in formula(latex, display=True)
