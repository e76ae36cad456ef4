"""What a ROS node of a student's did, as its kernel says."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import islice
from typing import Any

from course_lib.grading.replies import BadValue
from course_lib.grading.text import clean

_MOST_SAVED = 8  # pictures of a node; as many as `node_run` sends
_LAST = 2000  # characters of what a node said, no more than `clean` keeps


@dataclass(frozen=True)
class NodeRun:
    """What a ROS node did with the pictures it was given.

    Attributes
    ----------
    topics : dict of str to list of (int, object)
        What it published: stamp in ns, and an array (points, numbers), a BGR picture, a number or
        text.
    counts : dict of str to int
        How many messages it published on each topic.
    types : dict of str to str
        Of which type the messages on each topic are.
    unstamped : frozenset of str
        The topics on which the header's stamp is zero.
    files : dict of str to bytes
        The pictures it saved.
    error : str or None
        Why it ended, if it did not end well.
    log : str
        What it printed and logged.
    """

    topics: dict[str, list[tuple[int, Any]]]
    counts: dict[str, int]
    types: dict[str, str]
    unstamped: frozenset[str]
    files: dict[str, bytes] = field(repr=False)
    error: str | None
    log: str


def read(path: str, found: Any) -> NodeRun:  # noqa: ANN401
    """Read what a kernel says that a node did.

    Parameters
    ----------
    path : str
        The node's file, for messages.
    found : object
        What `agent` answered: a stranger's words.

    Returns
    -------
    NodeRun

    Raises
    ------
    BadValue
        When it is not what an agent answers.
    """
    try:
        return NodeRun(
            topics={clean(str(n), 100): _messages(m) for n, m in found["topics"].items()},
            counts={clean(str(n), 100): int(c) for n, c in found["counts"].items()},
            types={clean(str(n), 100): clean(str(t), 100) for n, t in found["types"].items()},
            unstamped=frozenset(clean(str(n), 100) for n in found["unstamped"]),
            files={
                clean(str(n), 200): _bytes(data)
                for n, data in islice(found["files"].items(), _MOST_SAVED)
            },
            # The last line of a traceback says most.
            error=clean(error[-_LAST:]) if isinstance(error := found["error"], str) else None,
            log=clean(str(found["log"])[-_LAST:]),
        )
    except (TypeError, LookupError, ValueError, AttributeError, OverflowError) as error:
        raise BadValue(f"What {path} did could not be read.") from error


def _bytes(found: object) -> bytes:
    if not isinstance(found, bytes):  # of a number, `bytes` would make as many
        raise TypeError("not a file's content")
    return found


def _messages(found: object) -> list[tuple[int, Any]]:
    if not isinstance(found, list):
        raise TypeError("not a list of messages")
    return [(int(stamp), value) for stamp, value in found]
