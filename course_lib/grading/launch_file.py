"""
Reads a student's launch file: which nodes it starts, and with what. Nothing of it is executed.

Understood is what a launch file of this course may need: nodes, arguments with their defaults,
parameters, remappings, groups, conditions, other files of the package, and the substitutions of
text among them. What cannot be known here, such as an argument without a default, leaves out what
depends on it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from course_lib.grading.launch_scope import Scope
from course_lib.grading.launch_values import split_words
from course_lib.grading.launch_xml import LaunchError, read_xml
from course_lib.offline_ros.names import split_arguments

if TYPE_CHECKING:
    import xml.etree.ElementTree as ET
    from collections.abc import Mapping

    from course_lib.grading.launch_params import Parameters

_MOST_DEPTH = 20
_MOST_INCLUDED = 50
_MOST_NODES = 100


@dataclass(frozen=True)
class LaunchNode:
    """A node that a launch file starts.

    Attributes
    ----------
    package, type, name : str
        As in the file; empty where missing.
    params : dict of str to object
        Its private parameters; the others' names begin with a slash. Texts may hold
        `PACKAGE_FOLDER` and `HOME_FOLDER`.
    remaps : dict of str to str
        Names to use in place of others; `__ns` is the namespace, `__name` the name.
    arguments : tuple of str
        What else its command line holds. Texts may hold the folders, too.
    """

    package: str
    type: str
    name: str
    params: dict[str, Any]
    remaps: dict[str, str]
    arguments: tuple[str, ...] = ()


def read_launch(
    data: bytes, package: str = "unit4", files: Mapping[str, bytes] | None = None
) -> list[LaunchNode]:
    """Read which nodes a launch file starts when it is given no arguments.

    Parameters
    ----------
    data : bytes
        The file.
    package : str
        The name of the package that it belongs to.
    files : mapping of str to bytes, optional
        The package's files, which it may include or load.

    Returns
    -------
    list of LaunchNode

    Raises
    ------
    LaunchError
        When it is none that roslaunch would start.
    """
    scope = Scope({"unit4", package}, files or {})
    reader = _Reader()
    reader.read(_root(data, scope), scope)
    return reader.nodes(scope.params)


def _root(data: bytes, scope: Scope) -> ET.Element:
    scope.allowance.take(data)
    root = read_xml(data)
    if root.tag != "launch":
        raise LaunchError(f"should begin with <launch>, not <{str(root.tag)[:40]}>")
    return root


class _Reader:
    def __init__(self) -> None:
        self._included = 0
        self._nodes: dict[str, LaunchNode] = {}  # by full name

    def nodes(self, params: Parameters) -> list[LaunchNode]:
        """Return the nodes that were read; all parameters are set before the first is started."""
        return [
            replace(node, params=params.seen_by(node.remaps.get("__ns", ""), node.name))
            for node in self._nodes.values()
        ]

    def read(self, element: ET.Element, scope: Scope, depth: int = 0) -> None:
        """Take the elements below an element, in order."""
        if depth > _MOST_DEPTH:
            raise LaunchError("is nested too deeply")
        for child in element:
            if not scope.applies(child):
                continue
            if child.tag == "group":
                self.read(child, scope.inner(scope.text(child, "ns")), depth + 1)
            elif child.tag == "node":
                self._node(child, scope.inner(scope.text(child, "ns")))
            elif child.tag == "include":
                self._include(child, scope, depth + 1)
            else:
                scope.take(child)

    def _include(self, element: ET.Element, scope: Scope, depth: int) -> None:
        """Read another file of the package; of files elsewhere nothing is known."""
        path, data = scope.file(element)
        self._included += 1
        if data is None or self._included > _MOST_INCLUDED:
            return
        try:
            self.read(_root(data, scope), scope.included(element, path), depth)
        except LaunchError as error:
            raise LaunchError(f"includes {path}, which {error}") from None

    def _node(self, element: ET.Element, scope: Scope) -> None:
        package, kind, name, args = (
            scope.text(element, key) or "" for key in ("pkg", "type", "name", "args")
        )
        full = f"{scope.namespace}/{name}".lstrip("/")
        if "/" in name:
            raise LaunchError(f'names a node "{name[:60]}": a namespace belongs into ns="…"')
        if name and full in self._nodes:
            raise LaunchError(f'has two nodes of the name "{name[:60]}": roslaunch starts neither')
        if len(self._nodes) >= _MOST_NODES:
            raise LaunchError("starts far too many nodes")
        scope.node = full
        for key, value in scope.everyones.items():
            scope.params.put(f"{full}/{key}", value)
        for child in element:
            if scope.applies(child):
                scope.take(child)
        arguments, mappings = split_arguments(split_words(args))
        remaps = dict(scope.remaps)
        for left, right in mappings.items():
            if not left.startswith("_"):
                remaps[left] = right
            elif not left.startswith("__"):
                scope.params.put(f"{full}/{left[1:]}", scope.parsed(right))
        remaps |= {"__ns": scope.namespace} if scope.namespace else {}
        remaps |= {"__name": name} if name else {}
        node = LaunchNode(package, kind, name, {}, remaps, tuple(arguments))
        self._nodes[full if name else f"/{len(self._nodes)}"] = node
