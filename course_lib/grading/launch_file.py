"""
Reads a student's launch file: which nodes it starts, and with what. Nothing of it is executed.

Understood is what a launch file of this course may need: nodes, arguments with their defaults,
parameters, remappings, groups, conditions, and the substitutions of text among them. What cannot be
known here, such as an argument without a default, leaves out what depends on it.
"""

from __future__ import annotations

import re
import shlex
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from typing import Any

from course_lib.offline_ros.names import parse_value, split_arguments

# Known only where the node runs; what runs it puts the folders there.
PACKAGE_FOLDER, HOME_FOLDER = "$(find unit4)", "$(env HOME)"
_FOLDERS = (PACKAGE_FOLDER, HOME_FOLDER)
_MOST_BYTES = 200_000
_MOST_DEPTH = 20
_MOST_TEXT = 2000  # of a value: arguments made of arguments could double at every step
_SUBSTITUTION = re.compile(r"\$\((\w++)([^()]*+)\)")


class LaunchError(ValueError):
    """A launch file that cannot be read, worded for its writer."""


class _UnknownError(Exception):
    """A value depends on what is not known here."""


@dataclass(frozen=True)
class LaunchNode:
    """A node that a launch file starts.

    Attributes
    ----------
    package, type, name : str
        As in the file; empty where missing.
    params : dict of str to object
        Its private parameters. Texts may hold `PACKAGE_FOLDER` and `HOME_FOLDER`.
    remaps : dict of str to str
        Names to use in place of others; `__ns` is the namespace, `__name` the name.
    """

    package: str
    type: str
    name: str
    params: dict[str, Any]
    remaps: dict[str, str]


@dataclass
class _Scope:
    """What holds for the elements that follow."""

    args: dict[str, str | None]
    params: dict[str, Any] = field(default_factory=dict)
    remaps: dict[str, str] = field(default_factory=dict)
    namespace: str = ""

    def inner(self) -> _Scope:
        return _Scope(dict(self.args), dict(self.params), dict(self.remaps), self.namespace)


def read_xml(data: bytes) -> ET.Element:
    """Read an XML file that a stranger wrote.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    xml.etree.ElementTree.Element
        Its root.

    Raises
    ------
    LaunchError
        Too large, not UTF-8, with a document type (entities could make it grow), not well-formed.
    """
    if len(data) > _MOST_BYTES:
        raise LaunchError("is far too large for what it is")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise LaunchError("cannot be read as text: save it as UTF-8") from None
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise LaunchError("declares a document type or entities, which ROS does not need")
    try:
        return ET.fromstring(text)  # noqa: S314  (no entities, limited in size)
    except (ET.ParseError, ValueError, RecursionError) as error:
        raise LaunchError(f"is not well-formed XML: {error}") from None


def read_launch(data: bytes, package: str = "unit4") -> list[LaunchNode]:
    """Read which nodes a launch file starts when it is given no arguments.

    Parameters
    ----------
    data : bytes
        The file.
    package : str
        The name of the package that it belongs to.

    Returns
    -------
    list of LaunchNode

    Raises
    ------
    LaunchError
        When it is no launch file.
    """
    root = read_xml(data)
    if root.tag != "launch":
        raise LaunchError(f"should begin with <launch>, not <{str(root.tag)[:40]}>")
    return list(_Reader(package).nodes(root, _Scope({})))


class _Reader:
    def __init__(self, package: str) -> None:
        self._packages = {"unit4", package}

    def nodes(self, element: ET.Element, scope: _Scope, depth: int = 0) -> list[LaunchNode]:
        """Return the nodes below an element, in order."""
        if depth > _MOST_DEPTH:
            raise LaunchError("is nested too deeply")
        found = []
        for child in element:
            if not self._applies(child, scope):
                continue
            if child.tag == "group":
                inner = scope.inner()
                inner.namespace = _joined(scope.namespace, child.get("ns", ""))
                found += self.nodes(child, inner, depth + 1)
            elif child.tag == "node":
                found.append(self._node(child, scope.inner()))
            else:
                self._setting(child, scope)
        return found

    def _node(self, element: ET.Element, scope: _Scope) -> LaunchNode:
        package, kind, name = (
            self._text(element.get(key, ""), scope, "") for key in ("pkg", "type", "name")
        )
        # What stands outside, for all nodes or under this one's name, is private to it too.
        own = f"/{name}/"
        params = {n: v for n, v in scope.params.items() if not n.startswith("/")}
        params |= {n[len(own) :]: v for n, v in scope.params.items() if n.startswith(own)}
        scope.params = {}
        for child in element:
            if self._applies(child, scope):
                self._setting(child, scope, within=True)
        params |= scope.params
        mappings = split_arguments(_words(self._text(element.get("args", ""), scope, "")))[1]
        for left, right in mappings.items():
            if left.startswith("_") and not left.startswith("__"):
                params[left[1:]] = parse_value(right)
            elif not left.startswith("__"):
                scope.remaps[left] = right
        namespace = _joined(scope.namespace, element.get("ns", ""))
        remaps = scope.remaps | ({"__ns": namespace} if namespace else {})
        if name:
            remaps["__name"] = name
        return LaunchNode(package, kind, name, params, remaps)

    def _setting(self, element: ET.Element, scope: _Scope, *, within: bool = False) -> None:
        """Take an argument, a parameter or a remapping into the scope."""
        name = element.get("name", "")
        if element.tag == "arg" and name:
            value = element.get("value", element.get("default"))
            scope.args[name] = None if value is None else self._text(value, scope)
        elif element.tag == "remap":
            source, target = (self._text(element.get(key, ""), scope) for key in ("from", "to"))
            if source and target:
                scope.remaps[source] = target
        elif element.tag == "param" and name and "value" in element.attrib:
            value = self._text(element.get("value", ""), scope)
            if value is not None:
                scope.params[_key(name, within=within)] = _typed(value, element.get("type", ""))
        elif element.tag == "rosparam" and element.get("command", "load") == "load":
            text = self._text(element.text or "", scope) or ""
            loaded = parse_value(text)
            if name:
                loaded = {name: loaded}
            if isinstance(loaded, dict):
                scope.params |= {_key(str(key), within=within): loaded[key] for key in loaded}

    def _applies(self, element: ET.Element, scope: _Scope) -> bool:
        for key, wanted in (("if", True), ("unless", False)):
            value = self._text(element.get(key, str(wanted)), scope)
            if value is not None and (value.strip().lower() in {"true", "1"}) != wanted:
                return False
        return True

    def _text(self, text: str, scope: _Scope, otherwise: Any = None) -> Any:  # noqa: ANN401
        """Put in what a text's substitutions stand for; what is not known makes it `otherwise`."""
        try:
            whole, end = "", 0
            for match in _SUBSTITUTION.finditer(text):
                whole += text[end : match.start()] + self._value(match, scope)
                end = match.end()
                if len(whole) > _MOST_TEXT:
                    return otherwise
        except _UnknownError:
            return otherwise
        return whole + text[end:]

    def _value(self, match: re.Match[str], scope: _Scope) -> str:
        kind, words = match[1], match[2].split()
        if kind == "dirname":
            return f"{PACKAGE_FOLDER}/launch"
        if not words:
            raise _UnknownError
        if kind == "find" and words[0] in self._packages:
            return PACKAGE_FOLDER
        if kind == "arg":
            value = scope.args.get(words[0])
            if value is not None:
                return value
        if kind in {"env", "optenv"} and words[0] == "HOME":
            return HOME_FOLDER
        if kind == "optenv":
            return " ".join(words[1:])
        if kind == "anon":
            return words[0]
        raise _UnknownError


def _words(text: str) -> list[str]:
    """Split arguments as a shell does, without splitting the folders' names, which have blanks."""
    for number, folder in enumerate(_FOLDERS):
        text = text.replace(folder, f"\0{number}")
    try:
        words = shlex.split(text)
    except ValueError:
        return []
    for number, folder in enumerate(_FOLDERS):
        words = [word.replace(f"\0{number}", folder) for word in words]
    return words


def _joined(outer: str, inner: str) -> str:
    return inner.strip("/") if inner.startswith("/") else f"{outer}/{inner}".strip("/")


def _key(name: str, *, within: bool) -> str:
    """Return a parameter's name: private ones bare, others from the root."""
    if within or name.startswith("~"):
        return name.lstrip("~/")
    return "/" + name.lstrip("/")


def _typed(value: str, kind: str) -> Any:  # noqa: ANN401
    """Turn a parameter's text into what roslaunch makes of it."""
    if kind in {"str", "string"}:
        return value
    if kind == "yaml":
        return parse_value(value)
    if kind in {"", "auto", "int"}:
        try:
            return int(value)
        except ValueError:
            pass
    if kind in {"", "auto", "int", "double"}:
        try:
            return float(value)
        except ValueError:
            pass
    lowered = value.strip().lower()
    return lowered == "true" if lowered in {"true", "false"} else value
