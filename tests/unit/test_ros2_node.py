"""Example 4.5 for ROS 2, as far as it can be looked at without ROS 2: it is not run."""

from __future__ import annotations

import ast
from pathlib import Path

SOLUTIONS = Path(__file__).parents[2] / "solutions"
ROS1 = SOLUTIONS / "unit4" / "src" / "example4_5.py"
ROS2 = SOLUTIONS / "unit4_ros2" / "example4_5.py"
# What the node calls of rclpy.node.Node and rclpy, from their documentation.
NODE_API = {"create_publisher", "create_subscription", "declare_parameter", "get_logger"}
RCLPY_API = {"init", "spin", "try_shutdown"}


def parts(file: Path) -> dict[str, str]:
    """The file's classes, functions and constants, as Python reads them."""
    named = {}
    for statement in ast.parse(file.read_text()).body:
        if isinstance(statement, ast.ClassDef | ast.FunctionDef):
            named[statement.name] = ast.dump(statement)
        elif isinstance(statement, ast.Assign):
            named[ast.unparse(statement.targets[0])] = ast.dump(statement.value)
    return named


def imported(file: Path) -> set[str]:
    found = set()
    for statement in ast.parse(file.read_text()).body:
        if isinstance(statement, ast.Import):
            found |= {alias.name for alias in statement.names}
        elif isinstance(statement, ast.ImportFrom):
            found |= {f"{statement.module}.{alias.name}" for alias in statement.names}
    return found


def test_finds_as_the_ros_1_node_does() -> None:
    ours, theirs = parts(ROS1), parts(ROS2)
    for name in ("MIN_INLIERS", "find_file", "ObjectFinder"):
        assert theirs[name] == ours[name]
    assert "main" in theirs


def test_imports_the_same_but_rospy() -> None:
    only_theirs = imported(ROS2) - imported(ROS1)
    assert only_theirs == {
        "rclpy",
        "rclpy.node.Node",
        "rclpy.qos.QoSProfile",
        "rclpy.qos.ReliabilityPolicy",
    }
    assert imported(ROS1) - imported(ROS2) == {"rospy"}


def test_publishes_and_reads_the_same_topics() -> None:
    def topics(file: Path) -> set[str]:
        constants = [n.value for n in ast.walk(ast.parse(file.read_text())) if hasattr(n, "value")]
        return {c for c in constants if isinstance(c, str) and c.startswith("/")}

    assert topics(ROS2) == topics(ROS1)
    assert len(topics(ROS1)) == 4


def test_calls_nothing_that_is_not_there() -> None:
    tree = ast.parse(ROS2.read_text())
    node = next(s for s in tree.body if isinstance(s, ast.ClassDef) and s.name == "ObjectNode")
    mine = {s.name for s in node.body if isinstance(s, ast.FunctionDef)}
    stored = {
        n.attr
        for n in ast.walk(node)
        if isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store)
    }
    used = {
        n.attr
        for n in ast.walk(node)
        if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name) and n.value.id == "self"
    }
    assert used - mine - stored == NODE_API
    called = {
        n.attr
        for n in ast.walk(tree)
        if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name) and n.value.id == "rclpy"
    }
    assert called == RCLPY_API


def test_is_a_program_of_its_own() -> None:
    assert ROS2.stat().st_mode & 0o111
    assert "course_lib" not in ROS2.read_text()
