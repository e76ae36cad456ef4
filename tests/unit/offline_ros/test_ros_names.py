"""ROS names and command line arguments."""

from __future__ import annotations

import numpy as np
import pytest

from course_lib.offline_ros.names import Names, as_yaml, parse_value, split_arguments


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


@pytest.mark.parametrize(
    "value",
    [
        58,
        1e-5,
        1e20,
        -0.25,
        True,
        "",
        "58",
        "yes",
        "a: b",
        "x" * 500,
        [1, [2.0, "3"]],
        {"a": {"n": None}},
    ],
)
def test_a_value_survives_the_command_line(value: object) -> None:
    text = as_yaml(value)
    assert "\n" not in text
    assert parse_value(text) == value
    assert type(parse_value(text)) is type(value)


def test_numpys_numbers_are_numbers() -> None:
    assert as_yaml({"r": np.float32(0.5), "n": (np.int64(3), 4)}) == "{r: 0.5, n: [3, 4]}"
    with pytest.raises(ValueError, match="a parameter is a number"):
        as_yaml(object())


def test_values_are_rospys_yaml() -> None:
    assert [
        parse_value(text) for text in ("y", "n", "no", "1e3", "1.0e+3", "[1", "2026-13-01")
    ] == [
        *("y", "n", False, "1e3", 1000.0, "[1", "2026-13-01"),
    ]


@pytest.mark.parametrize(
    "text", ["2001-02-30", "9" * 5000, "!!bool maybe", "!!int ''", "[" * 3000, "{a: [1, 2}"]
)
def test_a_parameter_that_is_no_yaml_is_the_text_itself(text):
    assert parse_value(text) == text
