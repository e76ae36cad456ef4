"""Where a package's files are looked for."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from course_lib.grading.node_answer import NodeRun
from course_lib.grading.ros_package import Package, what_went_wrong
from course_lib.grading.student import PackageFile


@pytest.mark.parametrize(
    ("names", "place"),
    [
        (["src/a.py", "scripts/a.py"], "src/a.py"),
        (["nodes/a.py", "test/a.py"], "nodes/a.py"),
        (["src/nodes/a.py", "src/other_a.py"], "src/nodes/a.py"),
        (["src/aa.py"], None),
    ],
)
def test_a_node_is_found_where_roslaunch_finds_it(names, place):
    files = {name: PackageFile(b"", executable=True) for name in names}
    assert Package(SimpleNamespace(package=files)).path("a") == place


@pytest.mark.parametrize(
    ("log", "said"),
    [
        ("rospy.exceptions.ROSInterruptException: ROS shutdown request", None),
        ("KeyError: 'a'\nrospy.exceptions.ROSInterruptException: rospy shutdown", "KeyError: 'a'"),
    ],
)
def test_that_a_node_was_shut_down_is_no_error(log, said):
    run = NodeRun({}, {}, {}, frozenset(), files={}, error=None, log=f"Traceback …\n{log}\n")
    assert what_went_wrong(run) == said
