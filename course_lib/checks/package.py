"""The public checks of the ROS package ``unit4/``: all there, and readable."""

from __future__ import annotations

import ast
import os
import re
import xml.etree.ElementTree as ET
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.checks.unwritten import unwritten
from course_lib.checks.work import Check, NotYetError, WrongError

if TYPE_CHECKING:
    from course_lib.checks.work import Work

FOLDER = Path("unit4")
# What `course release` leaves where a part is the student's to write.
_STUB = "Your part:"
_NEEDED = ("rospy", "sensor_msgs", "geometry_msgs", "cv_bridge")
_IMAGE_TOPIC = "/camera/rgb/image_raw"
_MOST_BYTES = 1_000_000
_ALSO = frozenset({".py", ".yaml", ".yml", ".launch", ".xml"})
_MOST_VALUE = 500  # characters
_ENCODING = re.compile(rb"""<\?xml[^>]*encoding=["']([\w.-]+)["']""")
_DECLARATION = re.compile(r"^\s*<\?xml[^>]*\?>")


def _read(name: str) -> str:
    path = FOLDER / name
    if not path.is_file():
        raise NotYetError(f"There is no file {path} yet.")
    if path.stat().st_size > _MOST_BYTES:
        raise WrongError(f"{path} is far too large for what it is.")
    try:
        data = path.read_bytes()
        # Only XML can say that it is written in something else.
        declared = _ENCODING.match(data) if path.suffix in {".xml", ".launch"} else None
        text = data.decode(declared[1].decode() if declared else "utf-8-sig")
    except (UnicodeDecodeError, LookupError, OSError) as error:
        raise WrongError(f"{path} cannot be read as text: {error}") from None
    for line in text.splitlines():
        if _STUB in line:
            raise NotYetError(f"{path}: {line.split(_STUB)[1].split('-->')[0].strip()}.")
    return text


def _xml(name: str, root: str) -> ET.Element:
    text = _read(name)
    if "<!ENTITY" in text:
        raise WrongError(f"unit4/{name} declares entities, which ROS does not need.")
    try:
        # The student's own file, without entities; its encoding has been seen to.
        tree = ET.fromstring(_DECLARATION.sub("", text, count=1))  # noqa: S314
    except ET.ParseError as error:
        raise WrongError(f"unit4/{name} is not well-formed XML: {error}.") from None
    if tree.tag != root:
        raise WrongError(f"unit4/{name} should begin with <{root}>, not <{tree.tag}>.")
    return tree


def _package_xml(_: Work) -> None:
    tree = _xml("package.xml", "package")
    if not (tree.findtext("name") or "").strip():
        raise WrongError("package.xml does not say <name>unit4</name>.")
    depends = {(each.text or "").strip() for each in tree if "depend" in each.tag}
    if missing := [name for name in _NEEDED if name not in depends and _is_imported(name)]:
        raise WrongError(
            f"The nodes import {', '.join(missing)}, so package.xml should depend on it: "
            f"<exec_depend>{missing[0]}</exec_depend>."
        )


def _is_imported(name: str) -> bool:
    """Tell whether a node imports a package; before there is a node, the exercise's do."""
    texts = [
        path.read_text(encoding="utf-8", errors="replace")
        for path in _everywhere("*.py")
        if path.stat().st_size <= _MOST_BYTES
    ]
    pattern = re.compile(rf"^[ \t]*+(?:from|import)[ \t]++{name}\b", re.MULTILINE)
    return not texts or any(pattern.search(text) for text in texts)


def _cmake(_: Work) -> None:
    # CMake cares neither for case nor for white space.
    text = re.sub(r"\s+", "", re.sub(r"#.*", "", _read("CMakeLists.txt"))).lower()
    for part in ("project(", "find_package(catkin", "catkin_package("):
        if part not in text:
            raise WrongError(f"CMakeLists.txt has no {part}…). Without it catkin does not build.")


def _node(name: str, words: tuple[str, ...], _: Work) -> None:
    file = _place(name)
    text = _read(file)
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError) as error:
        line = getattr(error, "lineno", None)
        raise WrongError(f"{name} is not Python: {error} (line {line}).") from None
    if node := unwritten(tree):
        call = node.exc
        hint = ""
        if isinstance(call, ast.Call) and call.args and isinstance(call.args[0], ast.Constant):
            hint = str(call.args[0].value)
        raise NotYetError(f"Line {node.lineno} of {name} is yours to write: {hint or '…'}.")
    text += "\n".join(_beside())
    if not re.search(r"^[ \t]*+(?:from|import)[ \t][^#\n]*\brospy\b", text, re.MULTILINE):
        raise WrongError(f"{name} does not import rospy.")
    for word in words:
        if word.strip("/") not in text and not _in_launch_file(name, word, text):
            raise WrongError(f"{name} should use the topic {word}, and does not name it.")
    if not text.startswith("#!"):
        raise WrongError(f"{name} should begin with #!/usr/bin/env python3, or it cannot be run.")
    if not os.access(FOLDER / file, os.X_OK):
        raise WrongError(f"{name} may not be executed: chmod +x unit4/{file}")


def _place(name: str) -> str:
    """Return where a node lies: in src, says the exercise; roslaunch finds it anywhere."""
    places = [f"src/{name}", *(p.relative_to(FOLDER).as_posix() for p in _everywhere(name))]
    return next((place for place in places if (FOLDER / place).is_file()), places[0])


def _everywhere(pattern: str) -> list[Path]:
    return sorted(path for path in FOLDER.rglob(pattern) if path.is_file())


def _beside() -> list[str]:
    """Return what else a node may be made of: modules, settings, files that others include."""
    paths = [path for path in _everywhere("*") if path.suffix in _ALSO]
    return [
        path.read_text(encoding="utf-8", errors="replace")
        for path in paths
        if not path.name.startswith("exercise4_2_") and path.stat().st_size <= _MOST_BYTES
    ]


def _in_launch_file(node: str, word: str, source: str) -> bool:
    launch = FOLDER / "launch" / node.replace(".py", ".launch")
    if not launch.is_file():
        return False
    text = _without_arguments(launch.read_text(encoding="utf-8", errors="replace"))
    parts = word.strip("/").split("/")
    # A namespace can stand for the beginning: <group ns="waterhole">, and in the node "image".
    spaced = any(
        re.search(rf"""ns=["']/?{"/".join(parts[:n])}/?["']""", text) for n in range(1, len(parts))
    )
    # So can the node's own name: "~corners" in a node that the launch file calls waterhole.
    named = re.search(rf"""name=["']{parts[0]}["']""", text)
    private = named is not None and f"~{'/'.join(parts[1:])}" in source
    return word in text or spaced or private


def _without_arguments(text: str) -> str:
    """Put the values of arguments in the place of `$(arg …)`, as roslaunch does."""
    for element in re.findall(r"<arg\b[^>]*>", text):
        pairs = dict(re.findall(r"""(\w+)\s*=\s*["']([^"']*)["']""", element))
        value = pairs.get("value", pairs.get("default"))
        if "name" in pairs and value is not None:
            text = text.replace(f"$(arg {pairs['name']})", value[:_MOST_VALUE])
    return text


def _launch(name: str, node: str, _: Work) -> None:
    tree = _xml(f"launch/{name}", "launch")
    nodes = list(tree.iter("node"))
    if not nodes and next(tree.iter("include"), None) is not None:
        return  # roslaunch knows what another file starts
    if not nodes:
        raise WrongError(f"{name} starts no <node>.")
    types = [each.get("type", "") for each in nodes]
    if any("$(" in each for each in types):
        return  # roslaunch knows what an argument stands for
    if node not in types:
        raise WrongError(f'{name} should start type="{node}", not "{types[0]}".')
    started = nodes[types.index(node)]
    if not started.get("name"):
        raise WrongError(f"The <node> in {name} has no name.")
    try:
        package = (_xml("package.xml", "package").findtext("name") or "").strip()
    except (NotYetError, WrongError):
        return  # that file has a row of its own
    if started.get("pkg") != package:
        raise WrongError(
            f'{name} takes its node from pkg="{started.get("pkg", "")}", but package.xml names '
            f"this package {package}."
        )


CHECKS = (
    Check("unit4/package.xml", "names the package and what it depends on", _package_xml),
    Check("unit4/CMakeLists.txt", "lets catkin build it", _cmake),
    Check(
        "unit4/src/exercise4_2_1.py",
        "takes a picture from the camera's topic",
        partial(_node, "exercise4_2_1.py", (_IMAGE_TOPIC,)),
    ),
    Check(
        "unit4/src/exercise4_2_2.py",
        "publishes the outlined picture and the corners",
        partial(_node, "exercise4_2_2.py", (_IMAGE_TOPIC, "waterhole/image", "waterhole/corners")),
    ),
    Check(
        "unit4/launch/exercise4_2_1.launch",
        "starts the first node",
        partial(_launch, "exercise4_2_1.launch", "exercise4_2_1.py"),
    ),
    Check(
        "unit4/launch/exercise4_2_2.launch",
        "starts the second node",
        partial(_launch, "exercise4_2_2.launch", "exercise4_2_2.py"),
    ),
)
