"""The parameter server of one node: what `_name:=value` gave and what the node sets."""

from __future__ import annotations

from typing import Any

from course_lib.offline_ros.modules import get_runtime

_NO_DEFAULT = object()


def _find(name: str) -> Any:  # noqa: ANN401  (parameters hold anything)
    parameters = get_runtime().parameters
    if name in parameters:
        return parameters[name]
    prefix = name.rstrip("/") + "/"
    tree: dict[str, Any] = {}
    for full, value in parameters.items():
        if full.startswith(prefix):
            *parents, leaf = full[len(prefix) :].split("/")
            branch = tree
            for parent in parents:
                branch = branch.setdefault(parent, {})
            branch[leaf] = value
    return tree or _NO_DEFAULT


def get_param(param_name: str, default: Any = _NO_DEFAULT) -> Any:  # noqa: ANN401
    """Give a parameter; `~name` is the node's own.

    Parameters
    ----------
    param_name : str
        Its name. A namespace gives a dictionary.
    default : object, optional
        What to give when it is not set.

    Returns
    -------
    object
        Its value.

    Raises
    ------
    KeyError
        When it is not set and there is no default.
    """
    full = get_runtime().names.resolve(param_name)
    value = _find(full)
    if value is not _NO_DEFAULT:
        return value
    if default is _NO_DEFAULT:
        raise KeyError(full)
    return default


def get_param_cached(param_name: str, default: Any = _NO_DEFAULT) -> Any:  # noqa: ANN401
    """Give a parameter (see `get_param`)."""
    return get_param(param_name, default)


def set_param(param_name: str, param_value: Any) -> None:  # noqa: ANN401
    """Set a parameter; a dictionary sets one for each of its keys."""
    runtime = get_runtime()
    full = runtime.names.resolve(param_name)
    _remove(full)
    if isinstance(param_value, dict):
        for key, value in param_value.items():
            set_param(f"{full}/{key}", value)
    else:
        runtime.parameters[full] = param_value


def has_param(param_name: str) -> bool:
    """Tell whether a parameter is set."""
    return _find(get_runtime().names.resolve(param_name)) is not _NO_DEFAULT


def _remove(full: str) -> bool:
    parameters = get_runtime().parameters
    doomed = [name for name in parameters if name == full or name.startswith(full + "/")]
    for name in doomed:
        del parameters[name]
    return bool(doomed)


def delete_param(param_name: str) -> None:
    """Unset a parameter.

    Raises
    ------
    KeyError
        When it is not set.
    """
    full = get_runtime().names.resolve(param_name)
    if not _remove(full):
        raise KeyError(full)


def search_param(param_name: str) -> str | None:
    """Look a parameter up in the node's own name, then in each namespace around it.

    Returns
    -------
    str or None
        Its full name.
    """
    names = get_runtime().names
    if param_name.startswith(("/", "~")):
        return names.resolve(param_name) if has_param(param_name) else None
    space = names.node
    while True:
        full = f"{space}/{param_name}"
        if _find(full) is not _NO_DEFAULT:
            return full
        if not space:
            return None
        space = space.rpartition("/")[0]


def get_param_names() -> list[str]:
    """Give the names of all parameters."""
    return sorted(get_runtime().parameters)
