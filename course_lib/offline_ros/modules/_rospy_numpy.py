"""`rospy.numpy_msg`: messages whose lists of numbers are arrays; bytes stay bytes, as on ROS."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from course_lib.offline_ros.messages import Message

_NUMBERS = re.compile(r"((?:u?int|float)(?:8|16|32|64))\[\d*\]")


@cache
def numpy_msg(msg_type: type[Message]) -> type[Message]:
    """Give a class of the same messages, which a subscriber gets with arrays in them.

    Parameters
    ----------
    msg_type : type
        A message class, such as `Image`.

    Returns
    -------
    type
        For `rospy.Subscriber`, `rospy.Publisher` and `rospy.wait_for_message`.
    """
    return type(f"Numpy_{msg_type.__name__}", (msg_type,), {"with_arrays": staticmethod(_arrays)})


def _arrays(message: Any) -> Any:  # noqa: ANN401  (any message class)
    for name, kind in zip(message.__slots__, message._slot_types, strict=True):  # noqa: SLF001
        if found := _NUMBERS.fullmatch(kind):
            value = getattr(message, name)
            if not isinstance(value, bytes):
                setattr(message, name, np.array(value, np.dtype(found[1])))
    return message
