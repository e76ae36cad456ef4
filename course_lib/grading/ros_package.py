"""A student's ROS package, read but not believed: its files, its launch files, its nodes' runs."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from course_lib.grading import node_source
from course_lib.grading.launch_file import LaunchNode, read_launch
from course_lib.grading.launch_xml import LaunchError, read_xml

if TYPE_CHECKING:
    import xml.etree.ElementTree as ET
    from collections.abc import Callable, Sequence

    from course_lib._validate import Image
    from course_lib.grading.node_answer import NodeRun
    from course_lib.grading.student import Student

    Frames = Sequence[tuple[int, Image]]

NAME = "unit4"
TOPIC = "/camera/rgb/image_raw"
NEEDED = ("rospy", "sensor_msgs", "geometry_msgs", "cv_bridge")
# What `course release` leaves where a part is the student's to write.
_STUB = "Your part:"
_FOLDERS = ("src/", "scripts/", "nodes/", "")
_NODE_SECONDS = 40.0
_CMAKE = ("project(", "find_package(catkin", "catkin_package(")
_INSTALLED = re.compile(r"\b(?:src|scripts|nodes)/[\w./-]+\.py\b")
_ERROR_LINE = re.compile(r"^\w[\w.]*(?:Error|Exception|Interrupt|error|: error)\b.*", re.MULTILINE)
# What ROS raises in whatever waits when it shuts a node down: on a robot nobody minds.
_AT_THE_END = re.compile(r"ROSInterruptException: (?:ROS shutdown request|rospy shutdown)")


class FaultError(Exception):
    """What is wrong with a file, worded for the student.

    Attributes
    ----------
    left : float
        The share of its points that it leaves.
    """

    def __init__(self, message: str, left: float = 0.0) -> None:
        super().__init__(message)
        self.left = left


class Package:
    """The files below ``unit4/``.

    Parameters
    ----------
    student : Student
        The submission's proxy.
    """

    def __init__(self, student: Student) -> None:
        self._student = student
        self._files = student.package

    def check_manifest(self) -> None:
        """Check ``package.xml``.

        Raises
        ------
        FaultError
            What is wrong with it.
        """
        root = self._xml("package.xml", "package")
        name = (root.findtext("name") or "").strip()
        depends = {(each.text or "").strip() for each in root if "depend" in str(each.tag)}
        imported = self._imports()
        missing = [each for each in NEEDED if each in imported and each not in depends]
        if missing:
            raise FaultError(
                f"The nodes import {', '.join(missing)}, so package.xml should depend on it: "
                f"<exec_depend>{missing[0]}</exec_depend>.",
                0.5,
            )
        if name != NAME:
            raise FaultError(f"package.xml should name the package: <name>{NAME}</name>.", 0.5)

    def check_cmake(self) -> None:
        """Check ``CMakeLists.txt``.

        Raises
        ------
        FaultError
            What is wrong with it.
        """
        text = re.sub(r"#.*", "", self._text("CMakeLists.txt"))
        bare = re.sub(r"\s+", "", text).lower()
        missing = [part for part in _CMAKE if part not in bare]
        if missing and _STUB in self._text("CMakeLists.txt"):
            raise FaultError("CMakeLists.txt is not done yet.")
        if missing:
            raise FaultError(
                f"CMakeLists.txt has no {missing[0]}…). Without it catkin does not build.",
                0.5 if len(missing) < len(_CMAKE) - 1 else 0.0,
            )
        for path in _INSTALLED.findall(text):
            if path not in self._files:
                raise FaultError(
                    f"CMakeLists.txt names {path[:80]}, but there is no such file in the package: "
                    "catkin does not build.",
                    0.5,
                )

    def check_launch(self, stem: str) -> None:
        """Check a launch file, given its name without suffix, which is its node's.

        Raises
        ------
        FaultError
            What is wrong with it.
        """
        file, kind = f"launch/{stem}.launch", f"{stem}.py"
        nodes = self._nodes(stem)
        if not nodes:
            raise FaultError(f"{file} starts no <node>.")
        node = next((each for each in nodes if each.type == kind), None)
        if node is None:
            raise FaultError(f'{file} should start type="{kind}", not "{nodes[0].type}".', 0.25)
        if node.package not in {NAME, self._name()}:
            raise FaultError(
                f'{file} takes its node from pkg="{node.package}", but the package is {NAME}.', 0.5
            )
        if not node.name:
            raise FaultError(f"The <node> in {file} has no name.", 0.5)
        if self.path(stem) is None:
            raise FaultError(f"{file} starts {kind}, but there is no such file in src/.", 0.25)
        # A namespace such as camera/rgb is no topic.
        remaps = [target for name, target in node.remaps.items() if not name.startswith("__")]
        own = [value for name, value in node.params.items() if not name.startswith("/")]
        named = [*remaps, *own]
        for topic in named:
            camera = isinstance(topic, str) and re.match(r"/?camera/", topic)
            if camera and not str(topic).lstrip("/").startswith(TOPIC.lstrip("/")):
                raise FaultError(f"{file} names {topic}; the camera's topic is {TOPIC}.", 0.5)

    def check_node(self, stem: str) -> None:
        """Check that a node's file can be started.

        Raises
        ------
        FaultError
            What is wrong with it.
        """
        path = self.path(stem)
        if path is None:
            raise FaultError(f"There is no file src/{stem}.py.")
        text = self._text(path)
        try:
            tree = node_source.parse(text)
        except ValueError as error:
            raise FaultError(f"{path} {error}.") from None
        if node_source.is_stub(tree):
            raise FaultError(f"{path} is not done yet (it raises NotImplementedError).")
        if fault := node_source.cannot_start(text, tree):
            raise FaultError(f"{path} {fault}.", 0.5)
        if not self._files[path].executable:
            raise FaultError(f"{path} may not be executed: chmod +x {NAME}/{path}", 0.5)

    def path(self, stem: str) -> str | None:
        """Return where a node's file is in the package."""
        places = [f"{folder}{stem}.py" for folder in _FOLDERS]
        # roslaunch looks everywhere in the package.
        places += sorted(name for name in self._files if name.endswith(f"/{stem}.py"))
        return next((place for place in places if place in self._files), None)

    def why_silent(self, stem: str) -> list[str]:
        """Guess, in whole sentences, why a node heard or found nothing."""
        path, launch = self.path(stem), f"launch/{stem}.launch"
        if path is None:
            return []
        given = self._text(launch) if launch in self._files else ""
        found = node_source.why_silent(self._text(path), TOPIC, given)
        return [f"{path} {sentence}" for sentence in found]

    def pictures(self) -> list[bytes]:
        """Return the files that may be templates, those named so first."""
        names = [n for n in self._files if n.lower().endswith((".png", ".jpg", ".jpeg", ".bmp"))]
        names.sort(key=lambda name: ("waterhole" not in name and "template" not in name, name))
        return [self._files[name].data for name in names]

    def run(
        self,
        stem: str,
        frames: Frames,
        did: Callable[[NodeRun], bool],
    ) -> NodeRun:
        """Run a node as its launch file would, and else without parameters.

        Parameters
        ----------
        stem : str
            The node's file without suffix.
        frames : sequence of (int, ndarray)
            Stamp in ns and BGR picture.
        did : callable
            Tells whether the node did what it is for. A launch file may name files that are on the
            student's own machine only, which the node can do without.

        Returns
        -------
        NodeRun

        Raises
        ------
        StudentError
            When it could not be run at all.
        FaultError
            When there is no such file, or it is not done.
        """
        path = self.path(stem)
        if path is None:
            raise FaultError(f"There is no file src/{stem}.py.")
        try:
            node = next((each for each in self._nodes(stem) if each.type == f"{stem}.py"), None)
        except FaultError:
            node = None  # that file has points of its own
        run = None
        if node and (node.params or node.arguments or set(node.remaps) - {"__name"}):
            run = self._run(path, frames, node)
        if run is None or not did(run):
            bare = self._run(path, frames, None)
            # If neither did it, what the launch file came to is what its writer would see.
            run = bare if run is None or did(bare) else run
        if "NotImplementedError" in f"{run.error} {run.log}" and not did(run):
            raise FaultError(f"{path} is not done yet (it raises NotImplementedError).")
        return run

    def _run(self, path: str, frames: Frames, node: LaunchNode | None) -> NodeRun:
        return self._student.run_node(
            path,
            frames,
            topic=TOPIC,
            params=node.params if node else None,
            remap=node.remaps if node else None,
            given=node.arguments if node else (),
            timeout=_NODE_SECONDS,
        )

    def _name(self) -> str:
        try:
            return (self._xml("package.xml", "package").findtext("name") or "").strip() or NAME
        except FaultError:
            return NAME

    def _nodes(self, stem: str) -> list[LaunchNode]:
        file = f"launch/{stem}.launch"
        self._text(file)
        try:
            files = {name: each.data for name, each in self._files.items()}
            nodes = read_launch(files[file], self._name(), files)
        except LaunchError as error:
            raise FaultError(f"{file} {error}.") from None
        if not nodes and _STUB in self._text(file):
            raise FaultError(f"{file} is not done yet.")
        return nodes

    def _xml(self, name: str, root: str) -> ET.Element:
        text = self._text(name)
        try:
            found = read_xml(self._files[name].data)
        except LaunchError as error:
            raise FaultError(f"{name} {error}.") from None
        if found.tag != root:
            raise FaultError(f"{name} should begin with <{root}>.")
        if _STUB in text and not any("rospy" in (each.text or "") for each in found):
            raise FaultError(f"{name} is not done yet.")
        return found

    def _text(self, name: str) -> str:
        if name not in self._files:
            raise FaultError(f"There is no file {NAME}/{name}.")
        return self._files[name].data[:1_000_000].decode("utf-8-sig", "replace")

    def _imports(self) -> set[str]:
        """Return the modules that the package's Python files import."""
        found: set[str] = set()
        for name in self._files:
            if name.endswith(".py"):
                pattern = r"^[ \t]*+(?:from|import)[ \t]++([a-z_0-9]+)"  # linear in its length
                found |= set(re.findall(pattern, self._text(name), re.MULTILINE))
        return found


def what_went_wrong(run: NodeRun) -> str | None:
    """Return the last error that a node raised or logged, in a line; None for none."""
    for text in (run.error or "", run.log):
        lines = [line for line in _ERROR_LINE.findall(text) if not _AT_THE_END.search(line)]
        if lines:
            last = str(lines[-1])[:300]
            meaning = node_source.meaning(str(lines[-1]))
            return f"{last.rstrip('.')}.{meaning}" if meaning else last
    first, *others = [line for line in (run.error or "").splitlines() if line.strip()] or [""]
    # That it crashed is no news; what follows may be, such as sys.exit's status.
    told = others[-1].strip() if others and first.endswith(" crashed") else first
    return told[:300] or None
