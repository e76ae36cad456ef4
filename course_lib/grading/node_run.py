"""Runs a student's ROS node in the sandbox, on given pictures; what it did comes back as data."""

from __future__ import annotations

import time
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from course_lib.grading.on_ros import run_on_ros
from course_lib.offline_ros import NodeError, OfflineRosError, run_node
from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.recorder import Recorder
from course_lib.real_ros import RosError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_lib.offline_ros import Recording

_MOST_MESSAGES = 2000  # of a topic
_MOST_PICTURES = 4  # of a topic, from its beginning: an outlined picture is looked at, not measured
_MOST_FILES = 8
_MOST_LOG = 4000
# Below ~ and /tmp, as in ~/Pictures/drone: without a sandbox they hold more than one could search.
_DEPTHS = ("*", "*/*", "*/*/*")
_TMP = "/tmp"  # noqa: S108
_PICTURES = frozenset({".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"})


def run(
    path: str,
    stamps: list[int],
    frames: list[bytes],
    topic: str,
    params: dict[str, Any],
    remap: dict[str, str],
    given: list[str],
    timeout: float,
    *,
    ros: bool = False,
) -> dict[str, object]:
    """Run a node on pictures, as plain data.

    An exception in a callback is logged and costs its picture only, as on a robot.

    Here, and nowhere else, it is decided on what a node runs.

    Parameters
    ----------
    path : str
        The node's file.
    stamps : list of int
        When each picture was taken, ns.
    frames : list of bytes
        The pictures, JPEG.
    topic : str
        Where they are published, raw.
    params : dict
        The node's private parameters, and those that are not its own, by their whole names, which
        begin with a slash. Where a text holds `$(find unit4)` or `$(env HOME)`, the
        package's folder or the working folder is meant.
    remap : dict of str to str
        Names to use in place of others.
    given : list of str
        What else stands on its command line, with the same folders.
    timeout : float
        Seconds.
    ros : bool, optional
        Whether it runs on real ROS, started by roslaunch, instead of on `offline_ros`.

    Returns
    -------
    dict
        `topics`: name → list of (stamp ns, value); `counts`: name → number of messages;
        `types`: name → type of message; `unstamped`: names whose messages leave the stamp at zero;
        `files`: pictures that it saved, name → bytes; `error`: None or why it ended; `log`.
    """
    started = time.time() - 1  # a file system's clock is coarse
    error = None
    placed = _with_folders(params)
    with TemporaryDirectory(prefix="frames_") as folder:
        bag = Path(folder) / "camera.bag"
        _write_bag(bag, stamps, frames, topic)
        recording: Recording | None
        try:
            if ros:
                recording = run_on_ros(
                    Path(path),
                    Path(folder),
                    bag,
                    placed,
                    remap,
                    [_placed(text) for text in given],
                    timeout,
                    has_saved=lambda: _saved(started),
                )
            else:
                recording = run_node(
                    path,
                    bag=bag,
                    params=placed,
                    remap=remap,
                    arguments=[_placed(text) for text in given],
                    timeout=timeout,
                    stall=timeout,
                    keep_going=True,
                )
        except NodeError as failure:
            recording, error = failure.recording, f"{failure}\n{failure.traceback}"
        except (OfflineRosError, RosError, OSError, ValueError) as failure:
            recording, error = None, str(failure)
    topics = {name: list(_values(recording, name)) for name in recording or ()}
    firsts = {name: next(recording.stream(name), None) for name in recording} if recording else {}
    return {
        "topics": topics,
        "counts": {name: len(recording[name]) for name in recording} if recording else {},
        "types": {name: first[1]._type for name, first in firsts.items() if first},  # noqa: SLF001
        "unstamped": [name for name, first in firsts.items() if first and _unstamped(first[1])],
        "files": _saved(started),
        "error": error and error[-_MOST_LOG:],
        # A node that published nothing has an empty recording, and much to say all the same.
        "log": "" if recording is None else recording.output[-_MOST_LOG:],
    }


def _with_folders(params: dict[str, Any]) -> dict[str, Any]:
    return {
        name: _placed(value) if isinstance(value, str) else value for name, value in params.items()
    }


def _placed(text: str) -> str:
    here = str(Path.cwd())
    if text == _TMP or text.startswith(f"{_TMP}/"):  # the machine's own may be closed to students
        text = gettempdir() + text.removeprefix(_TMP)
    return text.replace("$(find unit4)", f"{here}/unit4").replace("$(env HOME)", here)


def _write_bag(path: Path, stamps: list[int], frames: list[bytes], topic: str) -> None:
    compressed = message_class("sensor_msgs/CompressedImage")
    recorder = Recorder(path)
    for stamp, jpeg in zip(stamps, frames, strict=True):
        message = compressed(format="bgr8; jpeg compressed bgr8", data=jpeg)
        message.header.stamp.secs, message.header.stamp.nsecs = divmod(stamp, 10**9)
        recorder.write_message(f"{topic}/compressed", stamp, message)
    recorder.close()


def _values(recording: Recording | None, topic: str) -> Iterator[tuple[int, object]]:
    pictures = 0
    for number, (published, message) in enumerate(recording.stream(topic) if recording else ()):
        is_picture = message._type in {"sensor_msgs/Image", "sensor_msgs/CompressedImage"}  # noqa: SLF001
        pictures += is_picture
        if number >= _MOST_MESSAGES or pictures > _MOST_PICTURES:
            return
        header = getattr(message, "header", None)
        stamp = header.stamp.secs * 10**9 + header.stamp.nsecs if header else 0
        yield stamp or published, _value(message)


def _unstamped(message: Any) -> bool:  # noqa: ANN401
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    return stamp is not None and not (stamp.secs or stamp.nsecs)


def _value(message: Any) -> object:  # noqa: ANN401
    kind = message._type  # noqa: SLF001
    if kind in {"geometry_msgs/PolygonStamped", "geometry_msgs/Polygon"}:
        polygon = message.polygon if kind.endswith("Stamped") else message
        points = [(point.x, point.y) for point in polygon.points]
        return np.array(points, np.float64).reshape(-1, 2)
    if kind == "sensor_msgs/Image":
        return _picture(message)
    if kind == "sensor_msgs/CompressedImage":
        packed = np.frombuffer(message.data, np.uint8)
        return cv2.imdecode(packed, cv2.IMREAD_COLOR) if packed.size else None
    data = getattr(message, "data", None)
    if kind.startswith("std_msgs/") and data is not None:
        return np.asarray(data) if kind.endswith("MultiArray") else data
    return {"type": kind}


def _picture(message: Any) -> object:  # noqa: ANN401
    """Give a picture as BGR; None for an encoding that no student is asked to publish.

    And where the data are not as many as height and width say: it is one picture that is wrong, and
    what else the node published may be right.
    """
    channels = {"bgr8": 3, "rgb8": 3, "mono8": 1, "8UC3": 3, "8UC1": 1}.get(message.encoding)
    data = np.frombuffer(bytes(message.data), np.uint8)
    height, width = message.height, message.width
    if channels is None or not data.size or not height or data.size % height:
        return None
    rows = data.reshape(height, -1)
    if width * channels > rows.shape[1]:
        return None
    array = rows[:, : width * channels].reshape(height, width, channels)
    return array[..., ::-1] if message.encoding == "rgb8" else array


def _saved(since: float) -> dict[str, bytes]:
    """Give the pictures that were saved since a time, below the working folder, ~ or /tmp."""
    here = Path.cwd()
    found: dict[str, bytes] = {}
    # In a sandbox, ~ and /tmp are the submission's own, too.
    folders = (Path.home(), Path(gettempdir()))
    others = {path for folder in folders for depth in _DEPTHS for path in folder.glob(depth)}
    for path in [*sorted(here.rglob("*")), *sorted(others)]:
        if path.suffix.lower() not in _PICTURES or path.is_symlink() or not path.is_file():
            continue
        status = path.stat()
        if status.st_mtime >= since and status.st_size <= 8 * 2**20 and len(found) < _MOST_FILES:
            name = path.relative_to(here) if path.is_relative_to(here) else path
            found[name.as_posix()] = path.read_bytes()
    return found
