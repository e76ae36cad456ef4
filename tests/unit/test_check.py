"""The students' self-check: what is right, what is not and why, what is not yet."""

from __future__ import annotations

import argparse
import json
import re
from pathlib import Path
from typing import Any

import cv2
import nbformat
import numpy as np
import pytest
from nbformat.v4 import new_code_cell

from course_lib import check
from course_lib.checks.table import Row, Table, Verdict
from course_lib.checks.work import NotYetError, Work, WrongError
from course_lib.offline_ros import NodeError, run_node
from course_lib.publish.runner import run_notebook

ROOT = Path(__file__).resolve().parents[2]
SOLUTION = ROOT / "solutions" / "exercise_4_1.ipynb"
STUB = ROOT / "exercises" / "exercise_4_1.ipynb"


def source(path: Path = SOLUTION) -> str:
    """The cells that define something."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    texts = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    return "\n".join(text for text in texts if text.startswith(("import ", "def ")))


def names(text: str) -> dict[str, Any]:
    namespace: dict[str, Any] = {}
    exec(compile(text, "student", "exec"), namespace)  # noqa: S102
    return namespace


def changed(old: str, new: str) -> dict[str, Any]:
    """The solution with one mistake."""
    assert source().count(old) >= 1, f"the solution has no {old!r} any more"
    return names(source().replace(old, new))


def rows(function: str, namespace: dict[str, Any]) -> tuple[Row, ...]:
    return check("4.1", function, namespace=namespace).rows


def test_solution_is_right_in_every_row() -> None:
    table = check("4.1", namespace=names(source()))
    assert table.is_right, repr(table)
    assert [row.help for row in table.rows] == [""] * 6


def test_stub_is_not_yet_in_every_row_and_repeats_the_hint() -> None:
    table = check("4.1", namespace=names(source(STUB)))
    assert {row.verdict for row in table.rows} == {Verdict.NOT_YET}
    assert table.rows[0].help.startswith("Step 1: load ROS.png")


def test_empty_notebook_is_not_yet() -> None:
    table = check("4.1", namespace={})
    assert {row.verdict for row in table.rows} == {Verdict.NOT_YET}
    assert table.rows[0].help == "There is no function load_images yet. Has its cell been run?"


@pytest.mark.parametrize(
    ("function", "old", "new", "words"),  # words: one or another
    [
        ("load_images", '"ROS.png"), (400, 600)', '"ROS.png"), (600, 400)', "(width, height)"),
        ("load_images", "return mug, scene", "return scene, mug", "in the wrong order"),
        ("load_images", "return mug, scene", "return mug", "return mug, scene"),
        ("load_images", "return mug, scene", "return mug[:, :, ::-1], scene", "RGB"),
        ("load_images", "return mug, scene", "return mug[:, :, 0], scene", "grey"),
        ("load_images", "return mug, scene", "return mug / 255.0, scene", "uint8"),
        ("load_images", "return mug, scene", "return 255 - mug, scene", "not ROS.png"),
        ("load_images", 'images.load("ROS2.png"), (600', 'images.load("ROS2.png"), (640', "shape"),
        ("load_images", "return mug, scene", "return mug, None", "cv2.imread found no file"),
        ("load_images", 'load("ROS.png")', 'load("ROS3.png")', "raised MissingImageError"),
        ("find_keypoints", "BGR2GRAY", "RGB2GRAY", "cv2.COLOR_BGR2GRAY"),
        ("find_keypoints", "detectAndCompute(gray, None)", "detect(gray)", "return two things"),
        (
            "find_keypoints",
            "detectAndCompute(gray, None)",
            "detectAndCompute(gray, None)[::-1]",
            "in the wrong order",
        ),
        ("find_keypoints", "ORB_create(1000)", "ORB_create(50)", "Only 50 keypoints"),
        ("find_keypoints", "gray = ", "cv2.circle(image, (9, 9), 5, 0)\n    gray = ", "draws into"),
        ("match_keypoints", "crossCheck=True", "crossCheck=False", "crossCheck=True"),
        ("match_keypoints", "m.distance)", "-m.distance)", "the worst first"),
        ("match_keypoints", "m.distance)", "m.queryIdx)", "not sorted"),
        ("match_keypoints", "key=lambda m: m.distance", "key=len", "raised TypeError"),
        (
            "match_keypoints",
            "match(query_descriptors, train_descriptors)",
            "match(train_descriptors, query_descriptors)",
            "swapped",
        ),
        (
            "match_keypoints",
            "return sorted(matcher.match(query_descriptors, train_descriptors)",
            (
                "return (lambda found, key: [[one] for one in found])"
                "(matcher.match(query_descriptors, train_descriptors)"
            ),
            "knnMatch returns lists",
        ),
        ("locate_mug", "points_mug, points_scene,", "points_scene, points_mug,", "wrong way"),
        ("locate_mug", "h, w = mug", "w, h = mug", "Width and height are swapped"),
        ("locate_mug", "[0, h - 1], [w - 1, h - 1]", "[w - 1, h - 1], [0, h - 1]", "wrong order"),
        ("locate_mug", ", H).reshape(4, 2)", ", H)", ".reshape(4, 2)"),
        ("locate_mug", "return corners if", "return corners[:, ::-1] if", "x and y are swapped"),
        ("locate_mug", "return corners if", "return H if", "returns the homography"),
        ("locate_mug", "return corners if", "return corners_mug if", "the template's own corners"),
        ("locate_mug", "return corners if", "return corners.tolist() if", "not list"),
        ("locate_mug", "return corners if", "return corners * np.nan if", "NaN"),
        ("locate_mug", "inlier_count < 10", "inlier_count < 100", "returns None, but"),
        ("locate_mug", "[m.trainIdx].pt", "[m.queryIdx].pt", "raised IndexError|returns None"),
    ],
)  # fmt: skip
def test_usual_mistake_is_named(function: str, old: str, new: str, words: str) -> None:
    text = source()
    if "corners if" in old or "reshape(4, 2)" in old or old.startswith("[0, h"):
        # The mistake itself, not what a later test of the outline makes of it.
        text = text.replace("cv2.isContourConvex(corners) and area > 400", "True")
        text = text.replace("area = -cv2.contourArea(corners, oriented=True)", "area = 1")
    assert old in text
    table = check("4.1", function, namespace=names(text.replace(old, new)))
    wrong = [row for row in table.rows if row.verdict is Verdict.WRONG]
    assert wrong, repr(table)
    assert any(word in wrong[0].help for word in words.split("|")), wrong[0].help


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "H is None or inlier_count < 10",
            "H is None",
            "no mug",
        ),
        ("if len(best) < 4:\n        return None, 0", "", "raised error"),
        (
            "    if query_descriptors is None or train_descriptors is None:\n        return []\n",
            "",
            "raised",
        ),
    ],
)
def test_absence_that_is_not_thought_of_is_named(old: str, new: str, words: str) -> None:
    text = source().replace("cv2.isContourConvex(corners) and area > 400", "True")
    assert old in text
    last = rows("locate_mug", names(text.replace(old, new)))[-1]
    assert last.verdict is Verdict.WRONG
    assert words in last.help


@pytest.mark.parametrize(
    ("place", "verdict"),
    [("../images", Verdict.RIGHT), ("images", Verdict.RIGHT), ("../my_pictures", Verdict.WRONG)],
)
def test_pictures_that_grading_would_not_find_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str, verdict: Verdict
) -> None:
    """Where it is graded, the notebook's folder is another one."""
    (tmp_path / "exercises").mkdir()
    monkeypatch.chdir(tmp_path / "exercises")
    Path(place).symlink_to(ROOT / "images")
    text = re.sub(r'images\.load\("(\w+\.png)"\)', rf'cv2.imread("{place}/\1")', source())
    row = rows("load_images", names(text))[0]
    assert row.verdict is verdict
    assert verdict is Verdict.RIGHT or "only from this folder" in row.help


@pytest.mark.parametrize(
    ("detector", "norm"), [("SIFT_create", "NORM_L2"), ("AKAZE_create", "NORM_HAMMING")]
)
def test_other_detectors_are_right_too(detector: str, norm: str) -> None:
    create = f"(getattr(cv2, '{detector}', None) or cv2.xfeatures2d.{detector})()"
    text = source().replace("cv2.ORB_create(1000)", create).replace("NORM_HAMMING", norm)
    table = check("4.1", "find_keypoints", "match_keypoints", namespace=names(text))
    assert table.is_right, repr(table)


def test_a_ratio_test_is_right_too() -> None:
    own = names(source())

    def match(query: Any, train: Any) -> list[cv2.DMatch]:
        pairs = cv2.BFMatcher(cv2.NORM_HAMMING).knnMatch(query, train, k=2)
        kept = [m for m, n in pairs if m.distance < 0.8 * n.distance]
        return sorted(kept, key=lambda m: m.distance)

    own["match_keypoints"] = match
    assert check("4.1", "match_keypoints", namespace=own).is_right


def test_arrays_of_keypoints_and_matches_are_lists_too() -> None:
    own = names(source())
    find, match = own["find_keypoints"], own["match_keypoints"]
    own["find_keypoints"] = lambda image: tuple(
        found if number else np.array(found, dtype=object)
        for number, found in enumerate(find(image))
    )
    own["match_keypoints"] = lambda *both: np.array(match(*both), dtype=object)
    table = check("4.1", "find_keypoints", "match_keypoints", namespace=own)
    assert table.is_right, repr(table)


def test_unknown_names_say_what_there_is() -> None:
    with pytest.raises(ValueError, match=r"there are 4\.1, 4\.2"):
        check("4.3", namespace={})
    with pytest.raises(ValueError, match="load_images, find_keypoints"):
        check("4.1", "load_image", namespace={})


def test_names_come_from_the_caller() -> None:
    def load_images() -> None:
        raise NotImplementedError("mine")

    assert load_images.__name__ == "load_images"
    assert check("4.1", "load_images").rows[0].help == "Mine."


# ----- a student's function


def test_exception_shows_type_message_and_the_students_line() -> None:
    text = "import cv2\ndef f(x):\n    y = x + 1\n    return cv2.cvtColor(y, 'grey')\n"
    namespace: dict[str, Any] = {}
    import linecache  # noqa: PLC0415

    linecache.cache["<cell>"] = (len(text), None, text.splitlines(keepends=True), "<cell>")
    exec(compile(text, "<cell>", "exec"), namespace)  # noqa: S102
    with pytest.raises(WrongError, match=r"^f raised error: .*in your line: return cv2\.cvtColor"):
        Work(namespace).call("f", np.zeros((4, 4, 3), np.uint8))


def test_exit_and_overwritten_function_are_told() -> None:
    with pytest.raises(WrongError, match="raised SystemExit"):
        Work(names("import sys\ndef f():\n    sys.exit()")).call("f")
    with pytest.raises(WrongError, match="not a function any more"):
        Work({"f": 3}).call("f")
    with pytest.raises(NotYetError, match="This part is yours"):
        Work(names("def f():\n    raise NotImplementedError")).call("f")


def test_given_picture_is_a_copy() -> None:
    picture = np.zeros((4, 4, 3), np.uint8)
    with pytest.raises(WrongError, match=r"image\.copy"):
        Work(names("def f(image):\n    image[:] = 7")).call("f", picture)
    assert not picture.any()


# ----- the table


def test_table_is_escaped_and_readable_without_colour() -> None:
    table = Table(
        "4.1",
        (
            Row("f", "does <it>", Verdict.RIGHT),
            Row("g", "does that", Verdict.WRONG, "No: <script>alert(1)</script>"),
            Row("h", "is there", Verdict.NOT_YET, "Write it."),
        ),
    )
    page = table._repr_html_()
    assert "<script>" not in page
    assert "&lt;script&gt;" in page
    assert all(f"</span> {verdict.value}" in page for verdict in Verdict)
    assert '<th scope="row"' in page
    assert "background:#" not in page  # the page's own, dark or light
    assert repr(table).splitlines() == [
        "Exercise 4.1: 1 of 3 right.",
        "  ✓ right: f: does <it>",
        "  ✗ not right: g: does that",
        "    No: <script>alert(1)</script>",
        "  … not yet: h: is there",
        "    Write it.",
    ]
    assert not table.is_right
    assert table.as_dict()["rows"][2]["verdict"] == "not yet"


# ----- in a kernel, and on the command line


def test_notebook_shows_the_same_table_every_time() -> None:
    notebook = nbformat.read(SOLUTION, as_version=4)
    notebook.cells.append(new_code_cell("check('4.1', 'load_images')"))
    ran = [run_notebook(SOLUTION, notebook=notebook.copy()).cells[-1].outputs for _ in range(2)]
    assert ran[0] == ran[1]
    data = ran[0][0].data
    assert set(data) == {"text/plain", "text/html"}
    assert data["text/plain"].startswith("Exercise 4.1: right.")


def run_check(*options: str) -> int:
    parser = argparse.ArgumentParser()
    check.add_arguments(parser)
    return check.main(parser.parse_args(options))


def test_command_line_checks_the_saved_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    notebook = nbformat.read(SOLUTION, as_version=4)
    # A cell that raises, one that prints a lie, and one mistake.
    notebook.cells.insert(1, new_code_cell("1 / 0"))
    notebook.cells.append(new_code_cell("print('Exercise 4.1: all 6 right.')"))
    # And one with an Output widget.
    shown = "import ipywidgets\nipywidgets.interact(lambda n: print(n), n=9)"
    notebook.cells.append(new_code_cell(shown))
    cell = next(c for c in notebook.cells if c.id == "match-keypoints")
    cell.source = cell.source.replace("m.distance)", "-m.distance)")
    path = tmp_path / "my exercise 4-1.ipynb"
    nbformat.write(notebook, path)
    before = path.read_bytes()
    assert run_check(str(path), "--json") == 1
    (table,) = json.loads(capsys.readouterr().out)
    wrong = {row["function"] for row in table["rows"] if row["verdict"] == "not right"}
    assert "match_keypoints" in wrong
    assert "load_images" not in wrong
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_command_line_is_satisfied_with_the_solution(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_check(str(SOLUTION)) == 0
    assert capsys.readouterr().out.startswith("Exercise 4.1: all 6 right.\n  ✓ right: load_images")


def test_command_line_says_what_cannot_be_checked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    half = tmp_path / "exercise_4_1.ipynb"
    half.write_text(SOLUTION.read_text()[:5000])
    unnamed = tmp_path / "mine.ipynb"
    assert run_check(str(half), str(unnamed), str(tmp_path / "exercise_4_2.ipynb")) == 2
    said = capsys.readouterr().err.splitlines()
    assert "not a notebook" in said[0]
    assert "which exercise is this" in said[1]
    assert "No such file" in said[2]


def test_unfinished_node_is_not_yet_and_a_broken_one_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    node = tmp_path / "node.py"
    node.write_text('raise NotImplementedError("wait for: one message")')
    with check.when_done():
        run_node(node, max_frames=1)
    assert capsys.readouterr().out == "Not yet: wait for: one message.\n"
    node.write_text('raise ValueError("NotImplementedError: no")')
    with pytest.raises(NodeError), check.when_done():
        run_node(node, max_frames=1)
