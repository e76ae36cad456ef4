"""What is said about a node's source is true of it, and nothing is said about one that works."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from independent_4_2 import FINDS, TAKES

from course_lib.grading.node_source import cannot_start, is_stub, meaning, parse, why_silent
from course_lib.grading.ros_package import what_went_wrong

TOPIC = "/camera/rgb/image_raw"
NODE = FINDS["functions"]


@pytest.mark.parametrize("text", [*FINDS.values(), *TAKES.values()])
def test_nothing_is_said_about_a_node_that_works(text):
    given = f'<remap from="image" to="{TOPIC}"/>'
    assert cannot_start(text, parse(text)) is None
    assert why_silent(text, TOPIC, given) == []


def test_an_empty_file_is_said_to_be():
    assert cannot_start("\n", parse("\n")) == "is empty"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("#!/usr", "# /usr", "should begin with #!"),
        ("python3\n", "python3\r\n", "Windows line ends"),
        ("import rospy", "import rospy, course_lib.matching", "imports course_lib"),
        ("import rospy", "from course_lib import matching\nimport rospy", "imports course_lib"),
    ],
)
def test_what_cannot_start_is_named(old, new, said):
    text = NODE.replace(old, new, 1)
    assert said in (cannot_start(text, parse(text)) or "")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("rospy.spin()", "", "rospy.spin() is missing"),
        (
            TOPIC,
            "/camera/image_raw",
            f"listens to /camera/image_raw; the camera's topic is {TOPIC}",
        ),
        ('os.path.join(here, "../waterhole.png")', '"C:/Users/lena/well.png"', "own computer only"),
        ("rospy.Subscriber(", "print(", "rospy.Subscriber is missing"),
        ("rospy.spin()", "print 'on'", "Python 2"),
        ("rospy.spin()", "rospy.spin(", "is not Python"),
        ("    kp2, des2", "\tkp2, des2", "inconsistent use of tabs"),
    ],
)
def test_why_a_node_is_silent_is_named(old, new, said):
    assert said in "\n".join(why_silent(NODE.replace(old, new, 1), TOPIC, ""))


def test_errors_are_explained_as_a_node_needs_it():
    assert "carried" in meaning("NameError: name 'fit_outline' is not defined")
    assert "def callback(message)" in meaning(
        "TypeError: callback() missing 1 required positional argument: 'msg'"
    )
    assert "setup.py" in meaning("ModuleNotFoundError: No module named 'unit4'")
    assert "a robot has no screen" in meaning("cv2.error: … The function is not implemented. Re…")
    # What means the same as in a notebook is told in the same words.
    assert "ratio test" in meaning("cv2.error: OpenCV(5.0.0) K == 1 && update == 0 && mask.empty()")
    assert meaning("RuntimeError: no idea") == ""


BASE = """class Finder:
    def find(self, frame):
        raise NotImplementedError
class Orb(Finder):
    def find(self, frame):
        return None
def decode(message):
    if message.encoding != "bgr8":
        raise NotImplementedError(message.encoding)
"""


@pytest.mark.parametrize(
    ("text", "stub"),
    [
        (BASE, False),
        ("raise NotImplementedError('MATCH_COUNT = …')", True),
        ("def f():\n while 1:\n  try:\n   raise NotImplementedError('x')\n  finally: pass", True),
        ("class Node:\n def find(self):\n  raise NotImplementedError('match')", True),
    ],
)
def test_only_what_is_still_to_be_written_is_a_stub(text, stub):
    assert is_stub(parse(text)) == stub


def test_what_a_command_line_lacks_is_told():
    left = "a.py crashed\n\nthe node left with sys.exit(2)"
    usage = (
        "usage: a.py [-h] template\na.py: error: the following arguments are required: template\n"
    )
    said = what_went_wrong(SimpleNamespace(error=left, log=usage))
    assert said == "a.py: error: the following arguments are required: template"
    said = what_went_wrong(SimpleNamespace(error=left, log=""))
    assert said == "the node left with sys.exit(2)"
    assert what_went_wrong(SimpleNamespace(error=None, log="")) is None
