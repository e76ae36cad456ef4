"""A launch file's values are what roslaunch itself makes of them."""

from __future__ import annotations

import json
import subprocess
from itertools import product

from course_lib.grading.launch_values import converted
from course_lib.real_ros import system

TEXTS = (
    *(
        "58",
        "0.75",
        "60.0",
        "1e3",
        "1.5e3",
        "1_000",
        "-3",
        "+4",
        ".5",
        "0x10",
        "007",
        "nan",
        "1.2.3",
    ),
    *("true", "False", " true ", "yes", "1", "0", "", "waterhole.png", "$(find unit4)/a.png"),
)
KINDS = ("auto", "str", "string", "int", "double", "bool", "boolean", "Int", "float")
ASK = """
import json, sys
from roslaunch.loader import convert_value
def ask(text, kind):
    try:
        return [True, repr(convert_value(text, kind))]
    except ValueError:
        return [False, ""]
print(json.dumps([ask(*pair) for pair in json.load(sys.stdin)]))
"""


def ours(text: str, kind: str) -> list[object]:
    try:
        return [True, repr(converted(text, kind))]
    except ValueError:
        return [False, ""]


def test_values_are_roslaunchs() -> None:
    pairs = list(product(TEXTS, KINDS))
    done = subprocess.run(
        [system.PYTHON, "-c", ASK],
        input=json.dumps(pairs),
        capture_output=True,
        text=True,
        check=True,
    )
    theirs = json.loads(done.stdout)
    different = [
        (pair, them, us)
        for pair, them in zip(pairs, theirs, strict=True)
        if them != (us := ours(*pair))
    ]
    assert not different
