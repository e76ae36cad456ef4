"""The checks behind `course_lib.check`, one file for each exercise."""
