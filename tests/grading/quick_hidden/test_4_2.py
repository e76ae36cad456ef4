"""A few questions about Exercise 4.2's package: its files, and what a node publishes."""

from __future__ import annotations

import numpy as np

from course_lib.grading.rubric import points

EXERCISE = "4.2"


@points(1, "4.2.1", "The package has its files")
def test_files(student, grade):
    grade.check("package.xml" in student.package, "unit4/ has no package.xml.")


@points(1, "4.2.2", "The node publishes corners")
def test_node(student, grade):
    frames = [(number * 10**8, np.full((480, 640, 3), 90, np.uint8)) for number in range(1, 5)]
    run = student.run_node("src/exercise4_2_2.py", frames, timeout=3)
    grade.check(run.error is None, f"The node: {run.error}")
    grade.check(run.topics.get("/waterhole/corners"), "The node published no corners.")
