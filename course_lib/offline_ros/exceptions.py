"""The exceptions of `rospy`, which nodes catch."""

from __future__ import annotations


class ROSException(Exception):  # noqa: N818  (rospy's name)
    """Base of what `rospy` raises."""


class ROSInitException(ROSException):
    """Something was used before `init_node`, or `init_node` was used twice."""


class ROSSerializationException(ROSException):
    """A message cannot be published as it is filled."""


class ROSInternalException(ROSException):
    """`rospy` itself failed."""


class ROSInterruptException(ROSException, KeyboardInterrupt):
    """The node was shut down while it slept or waited."""
