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


class ROSTimeMovedBackwardsException(ROSInterruptException):
    """The clock was set back; never raised here."""


class ServiceException(Exception):  # noqa: N818  (rospy's name)
    """A service failed; never raised here, where services are refused."""


class TransportException(Exception):  # noqa: N818  (rospy's name)
    """A connection failed; never raised here, where there are none."""


class TransportInitError(TransportException):
    """A connection could not be made; never raised here."""


class TransportTerminated(TransportException):
    """A connection broke; never raised here."""
