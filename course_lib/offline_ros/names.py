"""ROS graph names: resolving relative, private and global names, and command line remaps."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from io import StringIO
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError
from ruamel.yaml.resolver import VersionedResolver

_ARGUMENT = re.compile(r"^(?P<name>[~/\w][\w/]*):=(?P<value>.*)$", re.DOTALL)
_LEGAL = re.compile(r"^[~/A-Za-z][\w/]*$|^[~/]?$")


class _Resolver(VersionedResolver):
    """PyYAML's, which ROS reads with: there, `n: 58` is a count, and not what is false."""

    def resolve(self, kind: Any, value: Any, implicit: Any) -> Any:  # noqa: ANN401
        is_letter = value in {"y", "Y", "n", "N"} if isinstance(value, str) else False
        return super().resolve(kind, value, (False, True) if is_letter else implicit)


def split_arguments(argv: list[str]) -> tuple[list[str], dict[str, str]]:
    """Split a node's command line into plain arguments and `name:=value` pairs.

    Parameters
    ----------
    argv : list of str
        The arguments after the node's file.

    Returns
    -------
    plain : list of str
        What `rospy.myargv` leaves.
    mappings : dict of str to str
        `topic:=other`, `_param:=value`, `__name:=value`, by left side.
    """
    plain: list[str] = []
    mappings: dict[str, str] = {}
    for argument in argv:
        if match := _ARGUMENT.match(argument):
            mappings[match["name"]] = match["value"]
        else:
            plain.append(argument)
    return plain, mappings


def parse_value(text: str) -> Any:  # noqa: ANN401  (YAML gives what it holds)
    """Read a parameter's value as ROS does: as YAML, so `5` is an int and `true` a bool.

    Parameters
    ----------
    text : str
        The right side of `_param:=value`.

    Returns
    -------
    object
        The value; the text itself where it is no YAML.
    """
    yaml = YAML(typ="safe", pure=True)
    yaml.version = (1, 1)
    yaml.Resolver = _Resolver
    try:
        return yaml.load(StringIO(text)) if text else ""
    except YAMLError:
        return text


@dataclass
class Names:
    """The names of one node.

    Attributes
    ----------
    mappings : dict of str to str
        Everything given as `name:=value`.
    node : str
        The node's full name, known once `init_node` was called.
    """

    mappings: dict[str, str] = field(default_factory=dict)
    node: str = "/unnamed"

    @property
    def namespace(self) -> str:
        """The namespace the node lives in, ending in a slash."""
        namespace = "/" + self.mappings.get("__ns", "").strip("/")
        return namespace if namespace.endswith("/") else namespace + "/"

    def set_node(self, name: str) -> None:
        """Name the node; `__name:=` on the command line wins."""
        self.node = self.namespace + self.mappings.get("__name", name)

    def expand(self, name: str) -> str:
        """Give the global form of a name, without remapping.

        Parameters
        ----------
        name : str
            `chatter` (relative), `~chatter` (private) or `/chatter` (global).

        Returns
        -------
        str
            The name from the root, without a trailing slash.

        Raises
        ------
        ValueError
            When the name is not a legal ROS name.
        """
        if not isinstance(name, str) or not _LEGAL.match(name):
            msg = f"{name!r} is not a legal ROS name (letters, digits, _ and /)"
            raise ValueError(msg)
        if name.startswith("~"):
            name = f"{self.node}/{name[1:]}"
        elif not name.startswith("/"):
            name = self.namespace + name
        return re.sub(r"/+", "/", name).rstrip("/") or "/"

    def resolve(self, name: str) -> str:
        """Give the global form of a name after remapping (see `expand`)."""
        full = self.expand(name)
        for left, right in self.mappings.items():
            if not left.startswith("_") and self.expand(left) == full:
                return self.expand(right)
        return full

    def topic(self, name: str) -> str:
        """Give the topic that a publisher or subscriber of this name has.

        rospy resolves it twice, once in `Topic` and once in `_TopicImpl`: with `a:=b b:=c` what is
        published as `a` appears on `c`.
        """
        return self.resolve(self.resolve(name))

    def private_parameters(self) -> dict[str, Any]:
        """Give the `_param:=value` pairs, by resolved name."""
        return {
            self.expand("~" + left[1:]): parse_value(right)
            for left, right in self.mappings.items()
            if left.startswith("_") and not left.startswith("__")
        }
