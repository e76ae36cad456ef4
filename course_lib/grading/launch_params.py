"""The parameters that a launch file sets, and which of them a node sees as its own."""

from __future__ import annotations

from typing import Any

from course_lib.grading.launch_values import joined
from course_lib.grading.launch_xml import LaunchError
from course_lib.offline_ros.names import leaves

_MOST = 1000  # values, each by itself or in a list
_MOST_DEPTH = 10


class Parameters:
    """The parameter server, as far as a launch file fills it."""

    def __init__(self) -> None:
        self._values: dict[str, Any] = {}

    def put(self, name: str, value: object) -> None:
        """Set a parameter; a dictionary sets one for each of its keys.

        Parameters
        ----------
        name : str
            Its full name.
        value : object

        Raises
        ------
        LaunchError
            When it is far too large; a few lines of YAML may come to billions of values.
        """
        full = name.strip("/")
        self._values |= leaves(f"/{full}" if full else "", _plain(value))
        if len(self._values) > _MOST:
            raise LaunchError("sets far too many parameters")

    def seen_by(self, namespace: str, name: str) -> dict[str, Any]:
        """Give all parameters as a node names them.

        Parameters
        ----------
        namespace, name : str
            The node's.

        Returns
        -------
        dict of str to object
            Its private parameters by their bare names, the others from the root.
        """
        own = f"/{joined(namespace, name)}/"
        return {
            full.removeprefix(own) if full.startswith(own) else full: value
            for full, value in self._values.items()
        }


def _plain(value: object) -> Any:  # noqa: ANN401
    """Copy what YAML made; what is no plain data, such as a date, becomes its text."""
    left = _MOST

    def copied(part: object, depth: int) -> Any:  # noqa: ANN401
        nonlocal left
        left -= 1
        if left < 0 or depth > _MOST_DEPTH:
            raise LaunchError("sets far too many parameters")
        if isinstance(part, dict):
            return {str(key): copied(inner, depth + 1) for key, inner in part.items()}
        if isinstance(part, list):
            return [copied(inner, depth + 1) for inner in part]
        return part if isinstance(part, bool | int | float | str | None) else str(part)

    return copied(value, 0)
