"""What the source of a student's ROS node tells about why it cannot work. It is read, never run."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from course_lib.checks.unwritten import unwritten
from course_lib.grading.error_hints import hint

if TYPE_CHECKING:
    from collections.abc import Iterator

_OWN_COMPUTER = re.compile(r"(/home/|/Users/|/mnt/|/media/|[A-Za-z]:[\\/])")
_WAITS = {"spin", "is_shutdown", "wait_for_message", "sleep"}
_HEARS = {"Subscriber", "wait_for_message"}
_UNTIDY = 500  # characters of a string in a message: a path is shorter
# What a node's last error means, where that differs from a notebook's; the first that fits.
_HINTS = (
    (
        r"^NameError",
        "Was a function of the notebook, or an import, not carried into the node's file?",
    ),
    (
        r"^ModuleNotFoundError: No module named 'unit4",
        (
            "That is your package: catkin makes its modules known if CMakeLists.txt calls "
            "catkin_python_setup() and there is a setup.py. A file beside the node is found "
            "without, by its own name."
        ),
    ),
    (
        r"^TypeError: .*positional argument",
        (
            "ROS calls a callback with the message and nothing else: def callback(message), and in "
            "a class def callback(self, message)."
        ),
    ),
    (
        r"^AttributeError: '?\w+'? object has no attribute '(on_|call|_call|image_|handle)",
        (
            "Is the callback's name spelled alike where it is defined and where rospy.Subscriber "
            "is given it?"
        ),
    ),
    (
        r"The function is not implemented",
        (
            "cv2.imshow opens a window, and a robot has no screen: publish the picture instead, or "
            "open a window only where there is a display."
        ),
    ),
    (
        r"(?<!mask\.)empty\(\)|'NoneType'|2D or 3D point sets",
        (
            "Something is None or empty here: a template that cv2.imread did not find, the "
            "descriptors of a frame without keypoints, a homography that does not exist. Look "
            "before you use it."
        ),
    ),
    (
        r"KeyError: '[~/]",
        "A parameter is not set. Give rospy.get_param a default, or set it in the launch file.",
    ),
)


def parse(text: str) -> ast.Module:
    """
    Parse a node.

    Parameters
    ----------
    text : str
        The file.

    Raises
    ------
    ValueError
        It is not Python; the message says why, after the file's name.
    """
    try:
        return ast.parse(text)
    except SyntaxError as error:
        if "Missing parentheses in call to" in str(error.msg):
            raise ValueError(
                f"is Python 2 (line {error.lineno}): in Python 3, print is a function, print(…)"
            ) from None
        where = f" (line {error.lineno})" if error.lineno else ""  # none for a null byte
        raise ValueError(f"is not Python{where}: {str(error.msg)[:_UNTIDY]}") from None
    except (ValueError, RecursionError, MemoryError):
        raise ValueError("is not Python") from None


def is_stub(tree: ast.Module) -> bool:
    """
    Tell whether a part of a node is still to be written (see `unwritten`).

    Parameters
    ----------
    tree : ast.Module
        The node.

    Returns
    -------
    bool
    """
    return unwritten(tree) is not None


def cannot_start(text: str, tree: ast.Module) -> str | None:
    """
    Say why a robot could not start a node's file, after the file's name; None if it could.

    Parameters
    ----------
    text : str
        The file, with its own line ends.
    tree : ast.Module
        The same, parsed.

    Returns
    -------
    str or None
    """
    if not text.strip():
        return "is empty"
    if not text.startswith("#!"):
        return "should begin with #!/usr/bin/env python3, or it cannot be run"
    if text.partition("\n")[0].endswith("\r"):
        return (
            "has Windows line ends, so Linux looks for a program of the name 'python3\\r'. Save it "
            "with line ends LF: editors show CRLF in the corner below, to be clicked on"
        )
    if "course_lib" in set(_imported(tree)):
        return "imports course_lib, which no robot has: carry the functions into the file"
    return None


def why_silent(text: str, topic: str, given: str) -> list[str]:
    """
    Guess why a node heard or found nothing.

    Parameters
    ----------
    text : str
        The file.
    topic : str
        What it should listen to.
    given : str
        What its launch file tells it, in which the topic may be named, too.

    Returns
    -------
    list of str
        Sentences that go on after the file's name.
    """
    try:
        tree = parse(text)
    except ValueError as error:
        return [f"{error}."]
    found = []
    called = {_name(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    if not called & _WAITS:
        found.append("never waits for messages: it ends at once. rospy.spin() is missing.")
    if not called & _HEARS:
        found.append("listens to no topic: rospy.Subscriber is missing.")
    listens = [name for name in _listens(tree) if name.strip("/") != topic.strip("/")]
    if listens and topic.strip("/") not in text + given:
        found.append(f"listens to {listens[0][:80]}; the camera's topic is {topic}.")
    paths = [each for each in _strings(tree) if _OWN_COMPUTER.match(each)]
    if paths:
        found.append(
            f"names {paths[0][:80]}, which is on your own computer only. Look beside the file, "
            "with Path(__file__).parent, or take the name from the launch file: $(find unit4)/…"
        )
    return found


def meaning(error: str) -> str:
    """
    Say what a node's error means, if it is one that students meet often.

    Parameters
    ----------
    error : str
        Its last line, such as ``"NameError: name 'np' is not defined"``.

    Returns
    -------
    str
        A blank and a sentence or two, or nothing.
    """
    fits = (text for pattern, text in _HINTS if re.search(pattern, error))
    kind, _, message = error.partition(": ")
    return next((f" {text}" for text in fits), hint(kind.rpartition(".")[2], message))


def _imported(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (each.name.partition(".")[0] for each in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield (node.module or "").partition(".")[0]


def _listens(tree: ast.Module) -> Iterator[str]:
    """Yield the topics that stand where a node begins to listen."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and _name(node.func) in _HEARS and node.args:
            first = node.args[0]
            if isinstance(first, ast.Constant) and isinstance(first.value, str):
                yield first.value


def _strings(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value[:_UNTIDY]


def _name(function: ast.expr) -> str:
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
