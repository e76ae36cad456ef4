"""What holds in a place of a launch file: arguments, parameters, other names."""

from __future__ import annotations

import posixpath
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Self

from course_lib.grading.launch_params import Parameters
from course_lib.grading.launch_text import Surroundings
from course_lib.grading.launch_values import PACKAGE_FOLDER, converted, joined
from course_lib.grading.launch_xml import MOST_BYTES, Allowance, LaunchError
from course_lib.offline_ros.names import parse_value

if TYPE_CHECKING:
    import xml.etree.ElementTree as ET
    from collections.abc import Collection, Mapping

_VALUES = {"value", "textfile", "binfile", "command"}
_TRUE = {"true", "1"}


@dataclass
class Scope:
    """What holds for the elements that follow.

    Attributes
    ----------
    packages : collection of str
        The package's names.
    files : mapping of str to bytes
        Its files.
    params : Parameters
        Of the whole launch.
    allowance : Allowance
        For all files of the launch.
    args, remaps : dict
    everyones : dict of str to object
        Parameters that are private to each node that follows.
    namespace : str
        Without slashes around it.
    node : str or None
        The full name of the node that the elements are in.
    given : frozenset of str
        Arguments that an including file has set.
    declared : set of str
        Arguments that were declared.
    folder : str
        Of the file.
    """

    packages: Collection[str]
    files: Mapping[str, bytes]
    params: Parameters = field(default_factory=Parameters)
    allowance: Allowance = field(default_factory=Allowance)
    args: dict[str, str | None] = field(default_factory=dict)
    remaps: dict[str, str] = field(default_factory=dict)
    everyones: dict[str, Any] = field(default_factory=dict)
    namespace: str = ""
    node: str | None = None
    given: frozenset[str] = frozenset()
    declared: set[str] = field(default_factory=set)
    folder: str = f"{PACKAGE_FOLDER}/launch"

    def inner(self, namespace: str | None = "") -> Self:
        """Return a scope within, whose settings do not hold outside."""
        return replace(
            self,
            args=dict(self.args),
            remaps=dict(self.remaps),
            everyones=dict(self.everyones),
            declared=set(self.declared),
            namespace=joined(self.namespace, namespace or ""),
        )

    def included(self, element: ET.Element, path: str) -> Self:
        """Return the scope of a file that is included: it has the arguments that it is given."""
        given = self.inner(self.text(element, "ns"))
        given.declared.clear()
        for child in element:
            if self.applies(child):
                given.take(child)
        names = {child.get("name", "") for child in element if child.tag == "arg"}
        everything = element.get("pass_all_args", "").lower() in _TRUE
        args = {n: v for n, v in given.args.items() if everything or n in names}
        return replace(
            given,
            args=args,
            given=frozenset(args),
            declared=set(),
            folder=posixpath.dirname(path),
        )

    def text(self, element: ET.Element, key: str) -> str | None:
        """Return an attribute with its substitutions; None where there is none, or not known."""
        text = element.get(key)
        return None if text is None else self._fill(text)

    def parsed(self, text: str) -> Any:  # noqa: ANN401
        """Return what YAML comes to."""
        self.allowance.take(text, yaml=True)
        return parse_value(text)

    def file(self, element: ET.Element) -> tuple[str, bytes | None]:
        """Return the path that the attribute `file` gives, and, in the package, what it holds."""
        path = posixpath.normpath(self.text(element, "file") or "")
        within = path.removeprefix(f"{PACKAGE_FOLDER}/")
        if within == path:
            return path, None
        if within not in self.files:
            raise LaunchError(f"needs {within[:80]}, but there is no such file in the package")
        return path, self.files[within]

    def applies(self, element: ET.Element) -> bool:
        """Tell whether an element's conditions hold, or are not known."""
        for key, wanted in (("if", True), ("unless", False)):
            value = self.text(element, key)
            if value is None:
                continue
            try:
                if converted(value, "bool") != wanted:
                    return False
            except ValueError:
                raise LaunchError(
                    f'has {key}="{value[:60]}", which is neither true nor false: roslaunch starts '
                    "nothing then"
                ) from None
        return True

    def take(self, element: ET.Element) -> None:
        """Do what an <arg>, <remap>, <param> or <rosparam> says."""
        match element.tag:
            case "arg":
                self._arg(element)
            case "remap":
                if not {"from", "to"} <= set(element.keys()):
                    raise LaunchError("has a <remap> without from or to")
                source, target = (self.text(element, key) for key in ("from", "to"))
                if source and target:
                    self.remaps[source] = target
            case "param":
                self._param(element)
            case "rosparam" if element.get("command", "load") == "load":
                self._rosparam(element)

    def _arg(self, element: ET.Element) -> None:
        name = element.get("name", "")
        if not name or {"value", "default"} <= set(element.keys()):
            raise LaunchError("has an <arg> without a name, or with both value and default")
        if name in self.declared:
            raise LaunchError(f'declares the <arg> "{name[:60]}" twice')
        self.declared.add(name)
        if name not in self.given:
            key = "default" if element.get("value") is None else "value"
            self.args[name] = self.text(element, key)

    def _param(self, element: ET.Element) -> None:
        if element.get("name") is None or not _VALUES & set(element.keys()):
            raise LaunchError("has a <param> without name or value")
        name, value = self.text(element, "name"), self.text(element, "value")
        kind = element.get("type", "auto")
        if not name or value is None:
            return
        if kind.lower() == "yaml":
            self._put(name, self.parsed(value))
            return
        try:
            self._put(name, converted(value.strip(), kind))
        except ValueError:
            raise LaunchError(
                f'gives the parameter {name[:60]} the type "{kind[:20]}", but its value '
                f'"{value.strip()[:60]}" is none: roslaunch starts nothing then'
            ) from None

    def _rosparam(self, element: ET.Element) -> None:
        text: str | None = element.text or ""
        if element.get("file") is not None:
            data = self.file(element)[1]
            text = (data or b"")[:MOST_BYTES].decode("utf-8-sig", "replace")
        if element.get("subst_value", "").lower() in _TRUE:
            text = self._fill(text or "")
        if not text or not text.strip():
            return
        loaded = self.parsed(text)
        name, space = (self.text(element, key) or "" for key in ("param", "ns"))
        if not name and not isinstance(loaded, dict):
            raise LaunchError("has a <rosparam> with neither `name: value` lines nor param=")
        self._put(f"{space.rstrip('/')}/{name}" if space else name, loaded)

    def _put(self, name: str, value: object) -> None:
        """Set a parameter: the node's, or, outside of one, every node's, or the namespace's."""
        if self.node is not None:
            self.params.put(f"{self.node}/{name.lstrip('~/')}", value)
        elif name.startswith("~"):
            self.everyones[name[1:].strip("/")] = value
        else:
            self.params.put(joined(self.namespace, name), value)

    def _fill(self, text: str) -> str | None:
        return Surroundings(self.args, self.folder, self.packages).fill(text)
