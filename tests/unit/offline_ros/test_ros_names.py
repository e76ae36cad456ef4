"""ROS names and command line arguments."""

from __future__ import annotations

import pytest

from course_lib.offline_ros.names import Names, parse_value, split_arguments


def test_arguments() -> None:
    assert split_arguments(["a:=b", "plain", "_x:=1", "__name:=n", "/t:=/u", "a=b"]) == (
        ["plain", "a=b"],
        {"a": "b", "_x": "1", "__name": "n", "/t": "/u"},
    )


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("5", 5),
        ("-0.5", -0.5),
        ("true", True),
        ("yes", True),
        ("[1, b]", [1, "b"]),
        ("{a: 1}", {"a": 1}),
        ('"5"', "5"),
        ("/camera/image", "/camera/image"),
        ("", ""),
        ("[broken", "[broken"),
        ("{n: 58, y: N, off: no}", {"n": 58, "y": "N", False: False}),  # as PyYAML has it
    ],
)
def test_values_are_read_as_yaml(text: str, value: object) -> None:
    parsed = parse_value(text)
    assert parsed == value
    assert type(parsed) is type(value)


@pytest.mark.parametrize(
    ("name", "full"),
    [("x", "/ns/x"), ("/x", "/x"), ("~x", "/ns/me/x"), ("a//b/", "/ns/a/b"), ("old", "/new")],
)
def test_resolving(name: str, full: str) -> None:
    names = Names({"__ns": "ns", "__name": "me", "old": "/new", "_p": "3"})
    names.set_node("node")
    assert names.node == "/ns/me"
    assert names.resolve(name) == full
    assert names.private_parameters() == {"/ns/me/p": 3}


@pytest.mark.parametrize("name", ["1x", "a b", "a-b", "ä"])
def test_illegal_names(name: str) -> None:
    with pytest.raises(ValueError, match="is not a legal ROS name"):
        Names().resolve(name)


@pytest.mark.parametrize(
    ("mappings", "topic"),
    [
        ({}, "/a"),
        ({"a": "b"}, "/b"),
        ({"a": "b", "b": "c"}, "/c"),  # as rospy 1.16 has it
        ({"a": "b", "b": "a"}, "/a"),
    ],
)
def test_a_topic_is_resolved_twice(mappings: dict[str, str], topic: str) -> None:
    assert Names(mappings).topic("a") == topic
