"""Find what is still to be written in a node's file."""

from __future__ import annotations

import ast

_STUB = "NotImplementedError"


def unwritten(tree: ast.Module) -> ast.Raise | None:
    """
    Return the first line that says of a part that it is still to be written.

    It raises NotImplementedError. Who raises that under a condition, such as for an encoding, or in
    a class that others of the file are made of, means something else by it.

    Parameters
    ----------
    tree : ast.Module
        The node's file.

    Returns
    -------
    ast.Raise or None
    """
    classes = [node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]
    bases = {_name(base) for each in classes for base in each.bases}
    waiting: list[ast.AST] = [tree]
    found = []
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Raise) and node.exc is not None:
            if any(isinstance(n, ast.Name) and n.id == _STUB for n in ast.walk(node.exc)):
                found.append(node)
        elif isinstance(node, ast.ClassDef) and node.name in bases:
            continue
        elif not isinstance(node, ast.If | ast.match_case | ast.ExceptHandler):
            waiting += ast.iter_child_nodes(node)
    return min(found, key=lambda node: node.lineno, default=None)


def _name(base: ast.expr) -> str:
    return base.attr if isinstance(base, ast.Attribute) else getattr(base, "id", "")
