"""The self-check of Exercise 4.2: the waterhole's functions, and the ROS package."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import cv2
import pytest

from course_lib import check, images
from course_lib.checks.table import Row, Table, Verdict

FUNCTIONS = ("crop_waterhole", "locate_waterhole", "best_match_count")
X, Y, W, H = images.truth("flight.bag")["template"]["rect"]
WORK = f"""
import cv2
import numpy as np


def crop_waterhole(frame):
    return frame[{Y}:{Y + H}, {X}:{X + W}]


def features(image):
    return cv2.ORB_create(1000).detectAndCompute(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None)


def locate_waterhole(template, frame, match_count):
    (kp_a, des_a), (kp_b, des_b) = features(template), features(frame)
    if des_a is None or des_b is None:
        return None
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(des_a, des_b)
    best = sorted(matches, key=lambda m: m.distance)[:match_count]
    if len(best) < 4:
        return None
    a = np.float32([kp_a[m.queryIdx].pt for m in best])
    b = np.float32([kp_b[m.trainIdx].pt for m in best])
    M, mask = cv2.findHomography(a, b, cv2.RANSAC, 5.0)
    if M is None or mask.sum() < 10:
        return None
    h, w = template.shape[:2]
    corners = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]).reshape(-1, 1, 2)
    corners = cv2.perspectiveTransform(corners, M).reshape(4, 2)
    return corners if cv2.isContourConvex(corners) else None


def best_match_count(template, frames, candidates=range(4, 1001, 18)):
    found = [sum(locate_waterhole(template, f, n) is not None for f in frames) for n in candidates]
    return list(candidates)[int(np.argmax(found))]
"""
PACKAGE = {
    "package.xml": '<?xml version="1.0"?>\n<package format="2"><name>unit4</name>'
    "<exec_depend>rospy</exec_depend><exec_depend>sensor_msgs</exec_depend>"
    "<exec_depend>geometry_msgs</exec_depend><exec_depend>cv_bridge</exec_depend></package>",
    "CMakeLists.txt": "cmake_minimum_required(VERSION 3.0)\nproject(unit4)\n"
    "find_package(catkin REQUIRED)\ncatkin_package()\n",
    "src/exercise4_2_1.py": "#!/usr/bin/env python3\nimport rospy\n\n"
    'TOPIC = "/camera/rgb/image_raw"\n',
    "src/exercise4_2_2.py": "#!/usr/bin/env python3\nimport rospy\n\n"
    'TOPIC = "/camera/rgb/image_raw"\n'
    'OUT = "/waterhole/image", "/waterhole/corners"\n',
    "launch/exercise4_2_1.launch": '<launch><node pkg="unit4" type="exercise4_2_1.py" name="a"/>'
    "</launch>",
    "launch/exercise4_2_2.launch": '<launch><node pkg="unit4" type="exercise4_2_2.py" name="b"/>'
    "</launch>",
}


def names(old: str = "", new: str = "") -> dict[str, Any]:
    assert old in WORK
    namespace: dict[str, Any] = {}
    exec(compile(WORK.replace(old, new) if old else WORK, "student", "exec"), namespace)  # noqa: S102
    return namespace


@pytest.fixture
def unit4(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package that is right, in the notebook's folder."""
    monkeypatch.chdir(tmp_path)
    for name, text in PACKAGE.items():
        path = tmp_path / "unit4" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755 if path.suffix == ".py" else 0o644)
    return tmp_path / "unit4"


def row(table: Table, function: str) -> Row:
    """The first row of a function that is not right, or its first."""
    rows = [each for each in table.rows if each.function == function]
    return next((each for each in rows if each.verdict is not Verdict.RIGHT), rows[0])


@pytest.mark.usefixtures("unit4")
def test_right_work_is_right_in_every_row() -> None:
    table = check("4.2", namespace=names())
    assert table.is_right, repr(table)
    assert len(table.rows) == 12


@pytest.mark.usefixtures("tmp_path")
def test_nothing_is_not_yet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    table = check("4.2", namespace={})
    assert {each.verdict for each in table.rows} == {Verdict.NOT_YET}
    assert row(table, "unit4/package.xml").help == "There is no file unit4/package.xml yet."


@pytest.mark.parametrize(
    ("function", "old", "new", "words"),
    [
        ("crop_waterhole", f"[{Y}:{Y + H}, {X}:{X + W}]", f"[{X}:{X + W}, {Y}:{Y + H}]", "swapped"),
        ("crop_waterhole", f"[{Y}:{Y + H}, {X}:{X + W}]", "", "much else"),
        ("crop_waterhole", f"[{Y}:{Y + H}, {X}:{X + W}]", "[0:100, 0:100]", "does not show"),
        ("crop_waterhole", f"[{Y}:{Y + H}, {X}:{X + W}]", "[500:600, 0:100]", "Is it empty?"),
        ("crop_waterhole", f"{X}:{X + W}]", f"{X}:{X + W}, ::-1]", "not resized, BGR"),
        ("crop_waterhole", f"{X}:{X + W}]", f"{X}:{X + W}, 0]", "in colour"),
        ("locate_waterhole", "(a, b, cv2", "(b, a, cv2", "wrong way|far from|None"),
        ("locate_waterhole", ".reshape(4, 2)", "", ".reshape(4, 2)"),
        ("locate_waterhole", "mask.sum() < 10", "mask.sum() < 90", "too strict"),
        ("locate_waterhole", "m.distance", "-m.distance", "returns None, but the thing is there"),
        ("locate_waterhole", "< 10", "< 0", "There is no waterhole"),
        ("locate_waterhole", "    if len(best) < 4:\n        return None\n", "", "raised error"),
        # In which frame an outline folds by chance depends on OpenCV's own draws.
        *(
            [("locate_waterhole", "cv2.isContourConvex(corners)", "True", "There is no waterhole")]
            if cv2.__version__.startswith("5.")
            else []
        ),
        ("best_match_count", "list(candidates)[", "(lambda i: i + 5)(", "not among the candidates"),
        ("best_match_count", "list(candidates)[", "max([", "not list"),
        ("best_match_count", "np.argmax", "np.argmin", "With 4 matches"),
        ("best_match_count", "list(candidates)[", "candidates.step[", "raised AttributeError"),
    ],
)
def test_usual_mistake_is_named(function: str, old: str, new: str, words: str) -> None:
    if new == "(lambda i: i + 5)(":
        old, new = "list(candidates)[int(np.argmax(found))]", "5"
    if new == "max([":
        old, new = "list(candidates)[int(np.argmax(found))]", "[58]"
    text_names = names(old, new)
    found = row(check("4.2", function, namespace=text_names), function)
    assert found.verdict is Verdict.WRONG, found
    assert any(word in found.help for word in words.split("|")), found.help


@pytest.mark.parametrize("margin", [0, 20, -20])
def test_looser_and_tighter_crops_are_right_too(margin: int) -> None:
    text = f"[{Y - margin}:{Y + H + margin}, {X - margin}:{X + W + margin}]"
    namespace = names(f"[{Y}:{Y + H}, {X}:{X + W}]", text)
    assert check("4.2", "crop_waterhole", namespace=namespace).is_right


@pytest.mark.parametrize(
    ("file", "old", "new", "verdict", "words"),
    [
        ("package.xml", "</package>", "", "not right", "not well-formed"),
        ("package.xml", "<name>unit4</name>", "", "not right", "<name>unit4</name>"),
        ("package.xml", "rospy", "roscpp", "not right", "<exec_depend>rospy</exec_depend>"),
        ("package.xml", "<package", "<!-- Your part: name it --><package", "not yet", "name it."),
        ("package.xml", "<package", "<!DOCTYPE x [<!ENTITY a 'b'>]>", "not right", "entities"),
        ("CMakeLists.txt", "catkin_package()", "", "not right", "catkin_package("),
        ("CMakeLists.txt", "project", "# Your part: find\nproject", "not yet", "find"),
        ("src/exercise4_2_1.py", "/rgb", "", "not right", "/camera/rgb/image_raw"),
        ("src/exercise4_2_1.py", "import rospy", "import", "not right", "(line 2)"),
        ("src/exercise4_2_2.py", "waterhole/corners", "corners", "not right", "waterhole/corners"),
        ("src/exercise4_2_2.py", "#!/usr/bin/env python3", "", "not right", "#!/usr/bin"),
        ("src/exercise4_2_2.py", "OUT", "raise NotImplementedError('go')\nO", "not yet", "go."),
        ("launch/exercise4_2_1.launch", "4_2_1.py", "4_2_2.py", "not right", "start type="),
        ("launch/exercise4_2_2.launch", 'pkg="unit4"', 'pkg="me"', "not right", 'from pkg="me"'),
        ("launch/exercise4_2_2.launch", 'name="b"', "", "not right", "has no name"),
        ("launch/exercise4_2_2.launch", "<launch>", "<lunch>", "not right", "not well-formed"),
    ],
)  # fmt: skip
def test_fault_of_the_package_is_named(
    unit4: Path, file: str, old: str, new: str, verdict: str, words: str
) -> None:
    text = (unit4 / file).read_text()
    assert old in text
    (unit4 / file).write_text(text.replace(old, new))
    found = check("4.2", f"unit4/{file}", namespace={}).rows[0]
    assert found.verdict.value == verdict
    assert words in found.help


def test_node_that_may_not_be_executed_is_named(unit4: Path) -> None:
    (unit4 / "src/exercise4_2_1.py").chmod(0o644)
    found = check("4.2", "unit4/src/exercise4_2_1.py", namespace={}).rows[0]
    assert found.help.endswith("chmod +x unit4/src/exercise4_2_1.py")


def test_topic_may_stand_in_the_launch_file(unit4: Path) -> None:
    node, launch = unit4 / "src/exercise4_2_1.py", unit4 / "launch/exercise4_2_1.launch"
    node.write_text(node.read_text().replace("/camera/rgb/image_raw", "image"))
    remap = '<remap from="image" to="/camera/rgb/image_raw"/></launch>'
    launch.write_text(launch.read_text().replace("</launch>", remap))
    assert check("4.2", "unit4/src/exercise4_2_1.py", namespace={}).is_right


def test_topic_may_be_made_of_an_argument_or_begin_without_slash(unit4: Path) -> None:
    node, launch = unit4 / "src/exercise4_2_1.py", unit4 / "launch/exercise4_2_1.launch"
    text = node.read_text()
    node.write_text(text.replace("/camera/rgb/image_raw", "image"))
    remap = '<arg name="cam" default="/camera/rgb"/><remap from="image" to="$(arg cam)/image_raw"/>'
    launch.write_text(launch.read_text().replace("</launch>", f"{remap}</launch>"))
    assert check("4.2", "unit4/src/exercise4_2_1.py", namespace={}).is_right
    node.write_text(text.replace("/camera/rgb/image_raw", "camera/rgb/image_raw"))
    launch.write_text(launch.read_text().replace(remap, ""))
    assert check("4.2", "unit4/src/exercise4_2_1.py", namespace={}).is_right


@pytest.mark.parametrize("folder", ["scripts", "src/nodes"])
def test_nodes_may_lie_where_roslaunch_finds_them(unit4: Path, folder: str) -> None:
    (unit4 / folder).mkdir()
    for node in unit4.glob("src/*.py"):
        node.rename(unit4 / folder / node.name)
    assert check("4.2", "unit4/src/exercise4_2_1.py", namespace={}).is_right
    (unit4 / folder / "exercise4_2_1.py").chmod(0o644)
    found = check("4.2", "unit4/src/exercise4_2_1.py", namespace={}).rows[0]
    assert found.help.endswith(f"chmod +x unit4/{folder}/exercise4_2_1.py")


def test_a_node_may_be_made_of_other_files(unit4: Path) -> None:
    node = unit4 / "src/exercise4_2_1.py"
    (unit4 / "src/shot.py").write_text("import cv2, rospy  # and more\n")
    node.write_text("#!/usr/bin/env python3\nimport shot\n")
    assert "image_raw" in check("4.2", "unit4/src/exercise4_2_1.py", namespace={}).rows[0].help
    (unit4 / "all.yaml").write_text("topic: /camera/rgb/image_raw\n")
    assert check("4.2", "unit4/src/exercise4_2_1.py", namespace={}).is_right
    (unit4 / "src/shot.py").write_text("import cv2  # no rospy\n")
    assert "rospy" in check("4.2", "unit4/src/exercise4_2_1.py", namespace={}).rows[0].help


def test_a_class_that_others_are_made_of_is_not_unwritten(unit4: Path) -> None:
    node = unit4 / "src/exercise4_2_1.py"
    base = "\nclass Task:\n    def do(self):\n        raise NotImplementedError\n"
    node.write_text(f"{node.read_text()}{base}\nclass Save(Task):\n    pass\n")
    assert check("4.2", "unit4/src/exercise4_2_1.py", namespace={}).is_right
    node.write_text(f"{node.read_text()}{base.replace('Task', 'Other')}")
    assert not check("4.2", "unit4/src/exercise4_2_1.py", namespace={}).is_right


def test_the_manifest_names_what_is_imported_and_no_more(unit4: Path) -> None:
    manifest = unit4 / "package.xml"
    line = "<exec_depend>cv_bridge</exec_depend>"
    manifest.write_text(manifest.read_text().replace(line, ""))
    assert check("4.2", "unit4/package.xml", namespace={}).is_right
    node = unit4 / "src/exercise4_2_1.py"
    node.write_text(f"{node.read_text()}from cv_bridge import CvBridge\n")
    assert line in check("4.2", "unit4/package.xml", namespace={}).rows[0].help


def test_xml_may_say_how_it_is_written(unit4: Path) -> None:
    launch = unit4 / "launch" / "exercise4_2_1.launch"
    declared = '<?xml version="1.0" encoding="ISO-8859-1"?><!-- für -->'
    launch.write_bytes(f"{declared}{launch.read_text()}".encode("latin-1"))
    assert check("4.2", "unit4/launch/exercise4_2_1.launch", namespace={}).is_right


def test_a_namespace_may_stand_for_the_beginning_of_a_topic(unit4: Path) -> None:
    node = unit4 / "src" / "exercise4_2_2.py"
    node.write_text(node.read_text().replace('"/waterhole/', '"'))
    assert row(check("4.2", namespace={}), "unit4/src/exercise4_2_2.py").verdict is Verdict.WRONG
    launch = unit4 / "launch" / "exercise4_2_2.launch"
    inside = launch.read_text().replace("<launch>", '<launch><group ns="waterhole">')
    launch.write_text(inside.replace("</launch>", "</group></launch>"))
    assert row(check("4.2", namespace={}), "unit4/src/exercise4_2_2.py").verdict is Verdict.RIGHT


def test_the_nodes_own_name_may_stand_for_the_beginning_of_a_topic(unit4: Path) -> None:
    node = unit4 / "src" / "exercise4_2_2.py"
    node.write_text(node.read_text().replace('"/waterhole/', '"~'))
    assert row(check("4.2", namespace={}), "unit4/src/exercise4_2_2.py").verdict is Verdict.WRONG
    launch = unit4 / "launch" / "exercise4_2_2.launch"
    launch.write_text(launch.read_text().replace('name="b"', 'name="waterhole"'))
    assert row(check("4.2", namespace={}), "unit4/src/exercise4_2_2.py").verdict is Verdict.RIGHT


def test_cmake_cares_neither_for_case_nor_for_white_space(unit4: Path) -> None:
    text = "PROJECT(unit4)\nfind_package(\n  catkin REQUIRED\n)\ncatkin_package ( )\n"
    (unit4 / "CMakeLists.txt").write_text(text)
    assert row(check("4.2", namespace={}), "unit4/CMakeLists.txt").verdict is Verdict.RIGHT
    (unit4 / "CMakeLists.txt").write_text(text.replace("catkin_package", "# catkin_package"))
    assert "catkin_package(" in row(check("4.2", namespace={}), "unit4/CMakeLists.txt").help


def test_type_may_be_an_argument(unit4: Path) -> None:
    launch = unit4 / "launch" / "exercise4_2_2.launch"
    launch.write_text(launch.read_text().replace("exercise4_2_2.py", "$(arg node).py"))
    assert row(check("4.2", namespace={}), "unit4/launch/exercise4_2_2.launch").verdict is (
        Verdict.RIGHT
    )


def test_strange_files_are_told_and_not_raised(unit4: Path) -> None:
    (unit4 / "package.xml").write_bytes(b"\xff\xfe\x00\x01")
    (unit4 / "CMakeLists.txt").write_text("x" * 2_000_000)
    shutil.rmtree(unit4 / "launch")
    table = check("4.2", namespace={})
    assert "cannot be read" in row(table, "unit4/package.xml").help
    assert "far too large" in row(table, "unit4/CMakeLists.txt").help
    assert row(table, "unit4/launch/exercise4_2_1.launch").verdict is Verdict.NOT_YET
