"""`genpy`: the time classes and the base of all messages."""

from __future__ import annotations

from course_lib.offline_ros.messages import Message
from course_lib.offline_ros.times import Duration, Time

__all__ = ["Duration", "Message", "Time"]
