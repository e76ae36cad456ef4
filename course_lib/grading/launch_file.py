"""
Reads a student's launch file: which nodes it starts, and with what. Nothing of it is executed.

Understood is what a launch file of this course may need: nodes, arguments with their defaults,
parameters, remappings, groups, conditions, other files of the package, and the substitutions of
text among them. What cannot be known here, such as an argument without a default, leaves out what
depends on it.
"""

from __future__ import annotations

import posixpath
import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from course_lib.grading.launch_eval import NotUnderstoodError, evaluate
from course_lib.grading.launch_values import (
    HOME_FOLDER,
    PACKAGE_FOLDER,
    joined,
    parameter_key,
    split_words,
    typed,
)
from course_lib.grading.launch_xml import MOST_BYTES, LaunchError, read_xml
from course_lib.offline_ros.names import parse_value, split_arguments

if TYPE_CHECKING:
    import xml.etree.ElementTree as ET
    from collections.abc import Mapping

_MOST_DEPTH = 20
_MOST_INCLUDED = 50
_MOST_SHARED = 500  # parameters
_MOST_TEXT = 2000  # of a value: arguments made of arguments could double at every step
_WHOLE_EVAL = re.compile(r"\$\(eval (.*)\)", re.DOTALL)
_SUBSTITUTION = re.compile(r"\$\((\w++)([^()]*+)\)")


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
    arguments : tuple of str
        What else its command line holds. Texts may hold the folders, too.
    shared : dict of str to object
        The parameters that stand outside of nodes, such as ``/match_count``, for all to read.
    """

    package: str
    type: str
    name: str
    params: dict[str, Any]
    remaps: dict[str, str]
    arguments: tuple[str, ...] = ()
    shared: dict[str, Any] = field(default_factory=dict)


@dataclass
class _Scope:
    """What holds for the elements that follow."""

    args: dict[str, str | None]
    params: dict[str, Any] = field(default_factory=dict)
    remaps: dict[str, str] = field(default_factory=dict)
    namespace: str = ""
    given: frozenset[str] = frozenset()  # the args that an including file has set
    folder: str = f"{PACKAGE_FOLDER}/launch"  # of the file

    def inner(self) -> _Scope:
        return replace(
            self, args=dict(self.args), params=dict(self.params), remaps=dict(self.remaps)
        )


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
        When it is no launch file.
    """
    return _Reader(package, files or {}).all(_root(data))


def _root(data: bytes) -> ET.Element:
    root = read_xml(data)
    if root.tag != "launch":
        raise LaunchError(f"should begin with <launch>, not <{str(root.tag)[:40]}>")
    return root


class _Reader:
    def __init__(self, package: str, files: Mapping[str, bytes]) -> None:
        self._packages = {"unit4", package}
        self._files = files
        self._included = 0
        self._shared: dict[str, Any] = {}

    def all(self, root: ET.Element) -> list[LaunchNode]:
        """Return the nodes of a whole file."""
        found = self.nodes(root, _Scope({}))
        # roslaunch sets all parameters before it starts the first node.
        return [replace(node, shared=self._shared) for node in found]

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
                inner.namespace = self._namespace(child, scope)
                found += self.nodes(child, inner, depth + 1)
            elif child.tag == "node":
                found.append(self._node(child, scope.inner()))
            elif child.tag == "include":
                found += self._include(child, scope, depth + 1)
            else:
                self._setting(child, scope)
        return found

    def _include(self, element: ET.Element, scope: _Scope, depth: int) -> list[LaunchNode]:
        """Return the nodes of another file of the package; of files elsewhere nothing is known."""
        name, data = self._file(element, scope)
        self._included += 1
        if data is None or self._included > _MOST_INCLUDED:
            return []
        given = scope.inner()
        for child in element:
            if self._applies(child, scope):
                self._setting(child, given)
        names = {child.get("name", "") for child in element if child.tag == "arg"}
        passed = element.get("pass_all_args", "").lower() in {"true", "1"}
        inner = scope.inner()
        inner.args = {n: v for n, v in given.args.items() if passed or n in names}
        inner.given = frozenset(inner.args)
        inner.namespace = self._namespace(element, scope)
        inner.folder = posixpath.dirname(name)
        try:
            return self.nodes(_root(data), inner, depth)
        except LaunchError as error:
            raise LaunchError(f"includes {name}, which {error}") from None

    def _namespace(self, element: ET.Element, scope: _Scope) -> str:
        return joined(scope.namespace, self._text(element.get("ns", ""), scope, ""))

    def _file(self, element: ET.Element, scope: _Scope) -> tuple[str, bytes | None]:
        """Return the path that an element's attribute `file` gives, and what it holds."""
        path = posixpath.normpath(self._text(element.get("file", ""), scope, ""))
        return path, self._files.get(path.removeprefix(f"{PACKAGE_FOLDER}/"))

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
        words = split_words(self._text(element.get("args", ""), scope, ""))
        arguments, mappings = split_arguments(words)
        for left, right in mappings.items():
            if left.startswith("_") and not left.startswith("__"):
                params[left[1:]] = parse_value(right)
            elif not left.startswith("__"):
                scope.remaps[left] = right
        namespace = self._namespace(element, scope)
        remaps = scope.remaps | ({"__ns": namespace} if namespace else {})
        if name:
            remaps["__name"] = name
        return LaunchNode(package, kind, name, params, remaps, tuple(arguments))

    def _setting(self, element: ET.Element, scope: _Scope, *, within: bool = False) -> None:
        """Take an argument, a parameter or a remapping into the scope."""
        name = self._text(element.get("name", ""), scope, "")
        if element.tag == "arg" and name and name not in scope.given:
            value = element.get("value", element.get("default"))
            scope.args[name] = None if value is None else self._text(value, scope)
        elif element.tag == "remap":
            source, target = (self._text(element.get(key, ""), scope) for key in ("from", "to"))
            if source and target:
                scope.remaps[source] = target
        elif element.tag == "param" and name and "value" in element.attrib:
            value = self._text(element.get("value", ""), scope)
            if value is not None:
                self._set(name, typed(value, element.get("type", "")), scope, within=within)
        elif element.tag == "rosparam" and element.get("command", "load") == "load":
            for key, loaded in self._loaded(element, scope).items():
                self._set(str(key), loaded, scope, within=within)

    def _set(self, name: str, value: object, scope: _Scope, *, within: bool) -> None:
        """Set a parameter; outside of nodes, one for each leaf of a tree."""
        waiting = [(name, value)]
        while waiting:
            name, value = waiting.pop()
            if isinstance(value, dict) and not within and name.count("/") < _MOST_DEPTH:
                room = _MOST_SHARED - len(self._shared) - len(waiting)
                waiting += [(f"{name}/{key}", each) for key, each in value.items()][:room]
                continue
            key = parameter_key(name, within=within)
            scope.params[key] = value
            if key.startswith("/") and len(self._shared) < _MOST_SHARED:
                self._shared["/" + joined(scope.namespace, name)] = value

    def _loaded(self, element: ET.Element, scope: _Scope) -> dict[Any, Any]:
        """Return what a <rosparam> sets: its text or its file is YAML."""
        data = self._file(element, scope)[1] if "file" in element.attrib else None
        whole = (data or b"")[:MOST_BYTES].decode("utf-8-sig", "replace")
        if not whole or element.get("subst_value", "").lower() in {"true", "1"}:
            whole = self._text(whole or element.text or "", scope) or ""
        loaded = parse_value(whole)
        outer = [self._text(element.get(key, ""), scope, "") for key in ("ns", "param")]
        if where := joined(*outer):
            loaded = {where: loaded}
        return loaded if isinstance(loaded, dict) else {}

    def _applies(self, element: ET.Element, scope: _Scope) -> bool:
        for key, wanted in (("if", True), ("unless", False)):
            value = self._text(element.get(key, str(wanted)), scope)
            if value is not None and (value.strip().lower() in {"true", "1"}) != wanted:
                return False
        return True

    def _text(self, text: str, scope: _Scope, otherwise: Any = None) -> Any:  # noqa: ANN401
        """Put in what a text's substitutions stand for; what is not known makes it `otherwise`."""
        try:
            if found := _WHOLE_EVAL.fullmatch(text):
                return evaluate(found[1], lambda kind, word: self._known(kind, word, scope))
            whole, end = "", 0
            for match in _SUBSTITUTION.finditer(text):
                whole += text[end : match.start()] + self._known(match[1], match[2], scope)
                end = match.end()
                if len(whole) > _MOST_TEXT:
                    return otherwise
        except (_UnknownError, NotUnderstoodError):
            return otherwise
        return whole + text[end:]

    def _known(self, kind: str, text: str, scope: _Scope) -> str:
        words = text.split()
        if kind == "dirname":
            return scope.folder
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
