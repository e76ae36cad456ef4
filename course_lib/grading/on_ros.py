"""Runs a student's node on real ROS: by the student's launch file, and else by one of ours."""

from __future__ import annotations

import os
import re
import shlex
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

from course_lib.offline_ros import NodeError
from course_lib.offline_ros.own_modules import own_modules
from course_lib.real_ros import RosError, run_launch
from course_lib.real_ros.runner import rosparam

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from course_lib.offline_ros import Recording

_COURSE = Path(__file__).resolve().parents[2]
_MANIFEST = (
    '<package format="2"><name>{}</name><version>1.0.0</version><description>A node</description>'
    '<maintainer email="student@example.org">A student</maintainer><license>BSD</license></package>'
)
_SETS_SOMETHING = ("<param", "<rosparam", "<remap")


def run_on_ros(
    node: Path,
    folder: Path,
    bag: Path,
    params: Mapping[str, Any],
    remap: Mapping[str, str],
    given: Sequence[str],
    timeout: float,
    *,
    has_saved: Callable[[], object],
) -> Recording:
    """Start a node as its launch file does; if that brings nothing, start it by itself.

    Whether roslaunch can read the launch file and the manifest, and may execute the node, has
    points of its own. So a second try, by a file of ours that sets the same, does without.

    Parameters
    ----------
    node : Path
        Its file, from the working folder: `unit4/src/NAME.py`.
    folder : Path
        A temporary one.
    bag : Path
        What is played.
    params, remap : mapping
        Its private parameters, those with a slash in front that are not its own, and other names,
        as the student's launch file has them; if neither is given, a launch file that sets
        something is left aside.
    given : sequence of str
        What else that file puts on its command line.
    timeout : float
        Seconds for each try.
    has_saved : callable
        Tells whether it has saved a picture.

    Returns
    -------
    Recording

    Raises
    ------
    NodeError, RosError, OSError, ValueError
        As `run_launch` does.
    """
    package = Path.cwd() / node.parts[0]
    own = package / "launch" / f"{node.stem}.launch"
    text = own.read_text(errors="replace") if own.is_file() else ""
    if text and (params or remap or given or not any(tag in text for tag in _SETS_SOMETHING)):
        try:
            recording = _launch(package, own, bag, timeout)
        except NodeError as error:
            if error.recording is not None and _published(error.recording):
                raise
        except (RosError, OSError, ValueError):
            pass
        else:
            if _published(recording) or has_saved():
                return recording
    with _manifest(package) as name:
        node.chmod(0o755)  # roslaunch finds no other
        ours = folder / own.name
        ours.write_text(_launch_text(name, node, params, remap, given))
        return _launch(package, ours, bag, timeout)


def _launch(package: Path, launch: Path, bag: Path, timeout: float) -> Recording:
    return run_launch(package, launch, bag=bag, keep_going=True, timeout=timeout, home=".")


def _published(recording: Recording) -> bool:
    return any(topic != "/rosout" and len(recording[topic]) for topic in recording)


@contextmanager
def _manifest(package: Path) -> Iterator[str]:
    """Give the package a manifest that ROS can read, for a while, and its name."""
    file = package / "package.xml"
    before = file.read_bytes() if file.is_file() else None
    found = re.search(rb"<name>\s*([\w-]+)\s*</name>", before or b"")
    name = found[1].decode() if found else package.name
    file.write_text(_MANIFEST.format(name))
    try:
        yield name
    finally:
        if before is None:
            file.unlink()
        else:
            file.write_bytes(before)


def _launch_text(
    package: str,
    node: Path,
    params: Mapping[str, Any],
    remap: Mapping[str, str],
    given: Sequence[str],
) -> str:
    """Write a launch file. Python is named, so that the node's first line has no say."""
    attributes = {
        "pkg": package,
        "type": node.name,
        "name": remap.get("__name", node.stem),
        "output": "screen",
        "launch-prefix": "/usr/bin/python3",
    }
    if given:
        attributes["args"] = shlex.join(given)
    if "__ns" in remap:
        attributes["ns"] = remap["__ns"]
    # Offline a node may import the course, which costs some points; here, too.
    paths = os.pathsep.join(str(path) for path in (own_modules(node), _COURSE) if path)
    lines = [f'<env name="PYTHONPATH" value={quoteattr(paths)}/>']
    lines += [
        f"<remap from={quoteattr(source)} to={quoteattr(target)}/>"
        for source, target in remap.items()
        if not source.startswith("__")
    ]
    lines += [rosparam(name, value) for name, value in params.items() if not name.startswith("/")]
    # Within <node> these would be the node's own.
    shared = [rosparam(name, value) for name, value in params.items() if name.startswith("/")]
    start = " ".join(f"{name}={quoteattr(value)}" for name, value in attributes.items())
    return f"<launch>{''.join(shared)}<node {start}>{''.join(lines)}</node></launch>"
