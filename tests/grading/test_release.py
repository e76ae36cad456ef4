"""`exercises/` comes from `solutions/`, and students get nothing that they should not see."""

from __future__ import annotations

import argparse
import base64
import io
import json
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import pytest

from course_lib.grading import release
from course_lib.grading.bundle import FOLDER, write_bundle
from course_lib.grading.regions import ReleaseError, solutions, without_solutions

ROOT = Path(__file__).resolve().parents[2]
CANARY = "a canary that no student may hear"
SECRET_PLACES = [
    "tests/hidden/test_4_9.py",
    "tests/grading/samples/right/exercise_4_1.ipynb",
    "course_lib/grading/answers.py",
    "course_lib/grading/answers.js",
    "course_lib/scenes/answers.py",
    "course_lib/scenes.py",
    "images/heldout/mug_9.png",
    "images/heldout/truth/mug_9.json",
    "images/notes.md",
    "notebooks/.ipynb_checkpoints/4_1_fast.ipynb",
    "solutions/unit4/src/exercise4_2_9.py",
    "solutions/unit4/launch/exercise4_9.launch",
    "grades/anna/report.html",
    "secret.seed",
]


def run(*options: str) -> int:
    parser = argparse.ArgumentParser()
    release.add_arguments(parser)
    return release.main(parser.parse_args(options))


@pytest.fixture(scope="module")
def released() -> dict[str, release.Released]:
    return release.release(ROOT / "solutions")


# ----- exercises/


def test_exercises_are_what_solutions_give(released: dict[str, release.Released]) -> None:
    """Fails in CI when somebody edits one and forgets the other: run `course release`."""
    assert release.drift(released, ROOT / "exercises") == []
    assert run("--check") == 0


def test_every_kind_of_drift_is_named(
    tmp_path: Path, released: dict[str, release.Released]
) -> None:
    exercises = tmp_path / "exercises"
    assert release.write(released, exercises) == sorted(f"{name} is missing" for name in released)
    assert release.drift(released, exercises) == []
    notebook = exercises / "exercise_4_1.ipynb"
    notebook.write_text(notebook.read_text() + " ")
    (exercises / "unit4").mkdir(exist_ok=True)
    (exercises / "unit4" / "extra.py").write_text("")
    (exercises / "README.md").write_text("by hand")
    assert release.drift(released, exercises) == [
        "exercise_4_1.ipynb differs from what solutions/ gives",
        "unit4/extra.py does not come from solutions/",
    ]
    release.write(released, exercises)
    assert release.drift(released, exercises) == []
    assert (exercises / "README.md").read_text() == "by hand"
    notebook.chmod(0o755)
    assert release.drift(released, exercises) == [
        "exercise_4_1.ipynb has the wrong execute permission"
    ]


def test_stub_keeps_ids_and_tags_and_no_output(released: dict[str, release.Released]) -> None:
    for path in sorted((ROOT / "solutions").glob("*.ipynb")):
        whole = json.loads(path.read_text(encoding="utf-8"))["cells"]
        stub = json.loads(released[path.name].data)["cells"]
        assert [(c["id"], c["metadata"]) for c in stub] == [(c["id"], c["metadata"]) for c in whole]
        code = [cell for cell in stub if cell["cell_type"] == "code"]
        assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code)
        assert any("raise NotImplementedError(" in "".join(cell["source"]) for cell in code)


# ----- solution regions


def test_each_form_leaves_its_own_stub() -> None:
    text = (
        'def f():\n    ### BEGIN SOLUTION: say "hi"\n    return 1\n    ### END SOLUTION\n'
        "# BEGIN SOLUTION\nfind_package(catkin)\n# END SOLUTION\n"
        "  <!-- BEGIN SOLUTION: start it -->\n  <node/>\n  <!-- END SOLUTION -->\nlast"
    )
    assert without_solutions(text, "x").split("\n") == [
        "def f():",
        '    raise NotImplementedError("say \\"hi\\"")',
        "# Your part: this part is yours to write",
        "  <!-- Your part: start it -->",
        "last",
    ]
    assert solutions(text) == ["    return 1", "find_package(catkin)", "  <node/>"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("### BEGIN SOLUTION\n1", "never ends"),
        ("1\n### END SOLUTION", "line 2: this END SOLUTION has no BEGIN"),
        ("### BEGIN SOLUTION\n### BEGIN SOLUTION\n### END SOLUTION", "within a solution"),
        ("### BEGIN SOLUTION\n# END SOLUTION", "no BEGIN of the same form"),
        ("x = 1  ### BEGIN SOLUTION", "misspelt"),
        ("### Begin solution", "misspelt"),
        ("#### BEGIN SOLUTION", "misspelt"),
        ("### BEGIN_SOLUTION", "misspelt"),
    ],
)
def test_doubtful_mark_is_refused_rather_than_released(text: str, words: str) -> None:
    with pytest.raises(ReleaseError, match=words):
        without_solutions(text, "cell")


def test_stub_that_is_not_python_is_refused(tmp_path: Path) -> None:
    shutil.copy(ROOT / "solutions/exercise_4_1.ipynb", tmp_path)
    node = tmp_path / "unit4" / "src" / "node.py"
    node.parent.mkdir(parents=True)
    node.write_text("def f():\n    # BEGIN SOLUTION\n    return 1\n    # END SOLUTION\n")
    with pytest.raises(ReleaseError, match=r"node\.py: without its solution this is not Python"):
        release.release(tmp_path)


# ----- the bundle


@pytest.fixture(scope="module")
def bundle(tmp_path_factory: pytest.TempPathFactory, released: dict[str, release.Released]) -> Path:
    """The bundle of a repository in which everything secret sings."""
    root = tmp_path_factory.mktemp("repository")
    parts = ("course_lib", "notebooks", "images", "solutions", "exercises", ".ci")
    for part in parts:
        shutil.copytree(ROOT / part, root / part, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("LICENSE", "pyproject.toml", "requirements.lock"):
        shutil.copy(ROOT / name, root)
    for place in SECRET_PLACES:
        (root / place).parent.mkdir(parents=True, exist_ok=True)
        (root / place).write_text(CANARY)
    members = {f"exercises/{name}": (f.data, f.executable) for name, f in released.items()}
    target = root / "bundle.zip"
    write_bundle(root, members, target)
    first = target.read_bytes()
    for path in root.rglob("*"):  # another day, another checkout
        if path.is_file():
            path.touch()
    write_bundle(root, members, target)
    assert target.read_bytes() == first
    return target


def contents(data: bytes, name: str) -> list[tuple[str, bytes]]:
    """All that can be found in a file: itself, what a zip holds, what a notebook's outputs hold."""
    found = [(name, data)]
    if zipfile.is_zipfile(io.BytesIO(data)):
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            for inner in archive.namelist():
                found += contents(archive.read(inner), f"{name}/{inner}")
    if name.endswith(".ipynb"):
        for cell in json.loads(data)["cells"]:
            found.append((name, "".join(cell["source"]).encode()))
            for output in cell.get("outputs", []):
                for mime, value in output.get("data", {}).items():
                    text = "".join(value) if isinstance(value, list) else str(value)
                    found.append((f"{name}:{mime}", text.encode()))
                    if mime == "image/png":
                        found.append((f"{name}:{mime}", base64.b64decode(text)))
    return found


@pytest.fixture(scope="module")
def inside(bundle: Path) -> list[tuple[str, bytes]]:
    return contents(bundle.read_bytes(), "")


def where(inside: list[tuple[str, bytes]], needle: bytes) -> list[str]:
    return [name for name, data in inside if needle in data]


def test_bundle_holds_what_a_student_needs(bundle: Path) -> None:
    names = {name.removeprefix(f"{FOLDER}/") for name in zipfile.ZipFile(bundle).namelist()}
    assert {
        "README.md",
        "LICENSE",
        "Makefile",
        "pyproject.toml",
        "requirements.lock",
        ".ci/environment",
        ".ci/lab",
        "exercises/exercise_4_1.ipynb",
        "exercises/exercise_4_2.ipynb",
        "exercises/unit4/package.xml",
        "exercises/unit4/CMakeLists.txt",
        "exercises/unit4/src/exercise4_2_1.py",
        "exercises/unit4/src/exercise4_2_2.py",
        "exercises/unit4/launch/exercise4_2_1.launch",
        "exercises/unit4/launch/exercise4_2_2.launch",
        "exercises/README.md",
        "notebooks/index.ipynb",
        "images/ROS.png",
        "images/truth/ROS2.json",
        "images/flight.bag",
        "course_lib/check.py",
        "course_lib/offline_ros/__main__.py",
    } <= names


def test_bundle_holds_nothing_secret(inside: list[tuple[str, bytes]]) -> None:
    names = [name for name, _ in inside]
    assert not [n for n in names if "heldout" in n or "/hidden/" in n or "/grading" in n]
    assert where(inside, CANARY.encode()) == []
    assert len(inside) > 100  # the search did look


def code_of(name: str, data: bytes) -> str:
    """A file's text; of a notebook its code, as the prose may well name a call to use."""
    if not name.endswith(".ipynb"):
        return data.decode()
    cells = json.loads(data)["cells"] if data.startswith(b"{") else []
    return "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "code")


def test_bundle_holds_no_solution(inside: list[tuple[str, bytes]]) -> None:
    code = "\n".join(code_of(name, data) for name, data in inside if "/exercises/" in name)
    count = 0
    for path in sorted((ROOT / "solutions").rglob("*")):
        if path.suffix not in {".ipynb", ".py", ".launch", ".xml", ".txt"}:
            continue
        for region in solutions(code_of(path.name, path.read_bytes())):
            count += 1
            assert len(region) < 40 or where(inside, region.encode()) == []
            # What looks like the solution's own lines must not stand in the exercises either.
            for line in {line.strip() for line in region.split("\n") if len(line.strip()) > 40}:
                assert line not in code, line
    assert count >= 27


def test_nodes_in_the_bundle_may_be_executed_and_the_template_is_the_students(bundle: Path) -> None:
    infos = zipfile.ZipFile(bundle).infolist()
    nodes = [info for info in infos if "/unit4/src/" in info.filename]
    assert len(nodes) >= 3  # the example's, and two of the exercise
    assert all(info.external_attr >> 16 & 0o111 for info in nodes)
    assert not [info.filename for info in infos if "waterhole.png" in info.filename]


def test_stubs_of_the_package_are_still_what_they_should_be(
    released: dict[str, release.Released],
) -> None:
    package = {name: file for name, file in released.items() if name.startswith("unit4/")}
    assert len(package) >= 6
    for name, file in package.items():
        text = file.data.decode()
        if name.endswith((".launch", ".xml")):
            ET.fromstring(text)  # noqa: S314 (our own file)
            assert "<!-- Your part: " in text, name
        elif name.endswith(".py"):
            assert "raise NotImplementedError(" in text, name
            assert file.executable, name
        else:
            assert "# Your part: " in text, name


def test_bundle_holds_no_piece_of_a_held_out_file(inside: list[tuple[str, bytes]]) -> None:
    # Recordings share headers and JPEG tables, records the camera's matrix: those are no secret.
    public = b"".join(
        path.read_bytes() for path in (ROOT / "images").rglob("*.*") if "heldout" not in path.parts
    )
    pieces = 0
    for path in sorted((ROOT / "images/heldout").rglob("*.*")):
        data = path.read_bytes()
        for part in range(1, 8):
            piece = data[len(data) * part // 8 :][:48]
            if piece not in public:
                pieces += 1
                assert where(inside, piece) == [], path
    assert pieces > 100


UNPACKED = """
import pkgutil, importlib, sys, course_lib
from pathlib import Path
assert course_lib.__file__.startswith(sys.argv[1]), course_lib.__file__
names = [m.name for m in pkgutil.walk_packages(course_lib.__path__, "course_lib.")]
assert not [name for name in names if "grading" in name or "scenes" in name]
for name in names:
    # The stand-ins for ROS modules are imported by nodes, two more by real ROS; __main__ runs.
    others = ("__main__", "real_ros.player", "drone_node.ros_side")
    if "offline_ros.modules" not in name and not name.endswith(others):
        importlib.import_module(name)
assert (Path(course_lib.__file__).parent / "yard" / "light.npz").exists()
import argparse
from course_lib import check
parser = argparse.ArgumentParser()
check.add_arguments(parser)
notebooks = sorted(map(str, Path("exercises").glob("*.ipynb")))
sys.exit(check.main(parser.parse_args(["--json", *notebooks])))
"""


def test_unpacked_bundle_runs_and_says_not_yet(bundle: Path, tmp_path: Path) -> None:
    zipfile.ZipFile(bundle).extractall(tmp_path)
    folder = tmp_path / FOLDER
    ran = subprocess.run(
        [sys.executable, "-P", "-c", UNPACKED, str(folder)],
        cwd=folder,
        env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(folder), "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 1, ran.stderr
    tables = json.loads(ran.stdout)
    assert [table["exercise"] for table in tables] == ["4.1", "4.2"]
    rows = [row for table in tables for row in table["rows"]]
    assert {row["verdict"] for row in rows if "/" not in row["function"]} == {"not yet"}
    # A file of the package may be given whole.
    assert [row for row in rows if row["verdict"] == "not right"] == []
    assert len([row for row in rows if row["function"].startswith("unit4/")]) == 6
    assert all(row["help"] for row in rows if row["verdict"] == "not yet")


def test_unfinished_notebook_runs_to_its_end_without_an_error(bundle: Path, tmp_path: Path) -> None:
    zipfile.ZipFile(bundle).extractall(tmp_path)
    folder = tmp_path / FOLDER
    options = ["-m", "course_lib.publish.execute", "exercises"]
    ran = subprocess.run(
        [sys.executable, "-P", *options],
        cwd=folder,
        env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(folder), "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    for name in ("exercise_4_1.ipynb", "exercise_4_2.ipynb"):
        text = (folder / "exercises" / name).read_text(encoding="utf-8")
        assert "Not yet: step 1" in text
        # A style sheet for code, stored with a node that is shown, names tracebacks too.
        assert "Traceback (most recent" not in text
        assert '"output_type": "error"' not in text
    # Nothing was written into the package that is not the student's.
    for path in (ROOT / "exercises" / "unit4").rglob("*.*"):
        if path.suffix in {".py", ".launch", ".xml", ".txt"}:
            unpacked = folder / path.relative_to(ROOT)
            assert unpacked.read_bytes() == path.read_bytes(), path


def test_bundle_command_makes_the_zip(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "course.zip"
    assert run("--check", "--bundle", str(target)) == 0
    assert zipfile.is_zipfile(target)
    assert "files for students" in capsys.readouterr().out
    assert run("--check", "--bundle", str(tmp_path / "nowhere" / "course.zip")) == 2
    assert "error:" in capsys.readouterr().err


def test_exercise_4_1_as_a_script_is_for_instructors_only(
    released: dict[str, release.Released], inside: list[tuple[str, bytes]]
) -> None:
    """Students write it as a notebook; the script and its launch file are the answer."""
    assert not [name for name in released if "exercise4_1." in name]
    assert not [name for name, _ in inside if "exercise4_1." in name]
    script = (ROOT / "solutions" / "unit4" / "src" / "exercise4_1.py").read_bytes()
    body = script.partition(b"def locate(")[2].partition(b"def run(")[0]
    assert body.count(b"\n") > 10
    assert where(inside, body) == []
    assert [name for name, _ in inside if name.endswith("launch/example4_5.launch")]
