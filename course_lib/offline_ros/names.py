"""ROS graph names: resolving relative, private and global names, and command line remaps."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from typing import Any

import yaml

_ARGUMENT = re.compile(r"^(?P<name>[~/\w][\w/]*):=(?P<value>.*)$", re.DOTALL)
_LEGAL = re.compile(r"^[~/A-Za-z][\w/]*$|^[~/]?$")


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
    try:
        return yaml.safe_load(text) if text else ""
    except Exception:  # noqa: BLE001  (dates that are none, numbers without end: all that it may be)
        return text


def as_yaml(value: object) -> str:
    """Write a parameter's value in a line that `parse_value`, and rospy, read as the same.

    Parameters
    ----------
    value : object
        A number, text, truth value, list or dict.

    Returns
    -------
    str

    Raises
    ------
    ValueError
        When it is none of these.
    """
    try:
        plain = json.loads(json.dumps(value, default=_of_numpy))
    except TypeError as error:
        msg = f"a parameter is a number, text, truth value, list or dict, not {value!r}"
        raise ValueError(msg) from error
    text = yaml.safe_dump(
        plain, default_flow_style=True, sort_keys=False, width=float("inf"), allow_unicode=True
    )
    return str(text).removesuffix("...\n").rstrip("\n")


def _of_numpy(value: Any) -> object:  # noqa: ANN401
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError


def leaves(name: str, value: Any) -> dict[str, Any]:  # noqa: ANN401
    """Give a parameter as the server keeps it: a dictionary is a namespace.

    Parameters
    ----------
    name : str
        Its full name.
    value : object

    Returns
    -------
    dict of str to object
        Each value that is none, by its full name.
    """
    if not isinstance(value, dict):
        return {name: value}
    found: dict[str, Any] = {}
    for key, inner in value.items():
        found |= leaves(f"{name}/{str(key).strip('/')}", inner)
    return found


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
        found: dict[str, Any] = {}
        for left, right in self.mappings.items():
            if left.startswith("_") and not left.startswith("__"):
                found |= leaves(self.expand("~" + left[1:]), parse_value(right))
        return found
