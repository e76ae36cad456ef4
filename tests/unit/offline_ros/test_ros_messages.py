"""Message classes against what ROS 1's generator makes."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from course_lib.offline_ros.exceptions import ROSSerializationException
from course_lib.offline_ros.messages import STORE, message_class, type_name
from course_lib.offline_ros.times import Duration, Time
from course_lib.offline_ros.wire import deserialize, serialize

# As `rosmsg md5` of ROS 1 noetic prints them.
MD5SUMS = {
    "std_msgs/Header": "2176decaecbce78abc3b96ef049fabed",
    "std_msgs/String": "992ce8a1687cec8c8bd883ec73ca41d1",
    "sensor_msgs/Image": "060021388200f6f0f447d0fcd9c64743",
    "sensor_msgs/CompressedImage": "8f7a12909da2c9d3332d540a0977563f",
    "sensor_msgs/CameraInfo": "c9a58c1b0b154e0e6da7578cb991d214",
    "geometry_msgs/Twist": "9f195f881246fdfa2798d1d3eebca84a",
    "geometry_msgs/PolygonStamped": "c6be8f7dc3bee7fe9e8d296070f53340",
}


@pytest.mark.parametrize("name", MD5SUMS)
def test_md5_sums_are_those_of_ros(name: str) -> None:
    assert message_class(name)._md5sum == MD5SUMS[name]
    assert type_name(message_class(name)) == name


def test_one_class_per_type() -> None:
    assert message_class("sensor_msgs/Image") is message_class("sensor_msgs/msg/Image")
    with pytest.raises(KeyError, match="no message type sensor_msgs/Picture"):
        message_class("sensor_msgs/Picture")


def test_defaults_and_arguments() -> None:
    image = message_class("sensor_msgs/Image")()
    assert image.data == b""
    assert image.header.stamp == Time(0)
    assert message_class("sensor_msgs/CameraInfo")().K == [0.0] * 9
    point_class = message_class("geometry_msgs/Point")
    assert point_class(1, 2, 3) == point_class(x=1, y=2, z=3)
    assert point_class(1, 2, 3) != point_class()
    with pytest.raises(TypeError, match=r"takes 3 positional arguments \(x, y, z\), got 2"):
        point_class(1, 2)
    with pytest.raises(AttributeError, match="geometry_msgs/Point has no field w"):
        point_class(w=1)
    with pytest.raises(AttributeError):
        point_class().w = 1
    assert message_class("rosgraph_msgs/Log").WARN == 4


def test_messages_do_not_share_what_they_hold() -> None:
    first, second = (message_class("geometry_msgs/Polygon")() for _ in range(2))
    first.points.append(message_class("geometry_msgs/Point32")(1, 2, 3))
    assert second.points == []
    assert copy.deepcopy(first) == first


def _filled(desc: object, rng: np.random.Generator) -> object:
    kind, detail = desc  # type: ignore[misc]
    if kind == 1:
        values = {"string": "grüße" * int(rng.integers(0, 3)), "bool": bool(rng.integers(0, 2))}
        return values.get(detail[0], int(rng.integers(0, 100)))
    if kind == 2:
        cls = message_class(detail)
        if cls in (Time, Duration):
            return cls(int(rng.integers(0, 99)), int(rng.integers(0, 10**9)))
        return cls(**{name: _filled(field, rng) for name, field in cls._fields})
    inner, length = detail
    values = [_filled(inner, rng) for _ in range(length if kind == 3 else rng.integers(0, 4))]
    if inner[0] == 1 and inner[1][0] in {"uint8", "char"}:
        return bytes(values)
    return tuple(values) if inner[0] == 1 and inner[1][0] != "string" else values


@pytest.mark.parametrize("name", sorted(STORE.fielddefs))
def test_every_type_survives_the_wire(name: str) -> None:
    if name.startswith("builtin_interfaces"):
        return
    message = _filled((2, name), np.random.default_rng(0))
    raw = serialize(message)  # type: ignore[arg-type]
    again = deserialize(raw, name)
    assert again == message
    assert serialize(again) == raw


@pytest.mark.parametrize(
    ("name", "field", "value", "said"),
    [
        ("std_msgs/Int8", "data", 200, r"Int8\.data = 200 does not fit in int8 \(-128 to 127\)"),
        ("std_msgs/Int32", "data", 1.5, r"Int32\.data must be a int32, not float 1\.5"),
        ("std_msgs/String", "data", 5, r"String\.data must be a string, not int 5"),
        ("std_msgs/Float32", "data", "x", r"Float32\.data must be a float32, not str 'x'"),
        (
            "geometry_msgs/Twist",
            "linear",
            (1, 2),
            r"linear must be a geometry_msgs/Vector3, not tu",
        ),
        ("sensor_msgs/CameraInfo", "K", [1.0], r"CameraInfo\.K must hold 9 values, not 1"),
        ("sensor_msgs/CameraInfo", "D", ["a"], r"CameraInfo\.D must be a list of float64"),
        ("std_msgs/Time", "data", 5, r"Time\.data must be a Time, not int"),
    ],
)
def test_wrong_values_are_named(name: str, field: str, value: object, said: str) -> None:
    message = message_class(name)()
    setattr(message, field, value)
    with pytest.raises(ROSSerializationException, match=said):
        serialize(message)


def test_lenient_where_ros_is() -> None:
    info = message_class("sensor_msgs/CameraInfo")(K=np.eye(3).ravel(), D=[0, 1])
    again = deserialize(serialize(info), "sensor_msgs/CameraInfo")
    assert again.K == (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    assert again.D == (0.0, 1.0)
    point = message_class("geometry_msgs/Point")(np.float32(1.5), np.int64(2), 3)
    assert deserialize(serialize(point), "geometry_msgs/Point").x == 1.5
    image = message_class("sensor_msgs/Image")(data=[1, 2, 3])
    assert deserialize(serialize(image), "sensor_msgs/Image").data == b"\1\2\3"


def test_text_is_what_rostopic_echo_prints() -> None:
    stamped = message_class("geometry_msgs/PolygonStamped")()
    stamped.header.frame_id = "camera"
    stamped.polygon.points = [message_class("geometry_msgs/Point32")(1, 2, 3)]
    assert str(stamped) == (
        "header: \n  seq: 0\n  stamp: \n    secs: 0\n    nsecs:         0\n"
        '  frame_id: "camera"\npolygon: \n  points: \n    - \n      x: 1\n      y: 2\n      z: 3'
    )
    assert str(message_class("std_msgs/String")()) == "data: ''"
