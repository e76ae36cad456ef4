"""What an error message means in this course, for the errors that students meet most."""

from __future__ import annotations

import re

# An error's type, a part of its message, and below it what it means; the first that fits is taken.
_TABLE = """
error: empty()
    A picture is empty: cv2.imread found no picture at that path and returned None.
    images.load("ROS.png") finds the course's pictures wherever the notebook lies.
error: The function is not implemented. Rebuild the library
    cv2.imshow opens a window, and a notebook has none: use drawing.show or matplotlib.
error: scn + 1 == m.cols
    The homography is None here: findHomography found none. Check before you use it.
error: src1.cols == src2.cols
    One of the two sets of descriptors is None, as that picture has no keypoints. Check first.
error: at least 4 corresponding point sets
    A homography needs four matches: count them first.
error: should be 2D or 3D point sets
    There are no matched points here. A homography needs four matches: count them first.
IndexError: tuple index out of range
    There are fewer keypoints than that: queryIdx counts those of the picture given to match()
    first, trainIdx the others.
NameError:
    Run all cells in a fresh kernel, from top to bottom (Kernel, Restart Kernel and Run All Cells):
    the name comes from a cell that was deleted or stands further down.
ModuleNotFoundError:
    Only what the course itself installs is there when your work is graded.
StdinNotImplementedError:
    Nobody is there to answer input() when your work is graded.
FileNotFoundError:
    Is the path one of your own computer? The course's pictures lie in ../images; hand in every
    other file that you need.
TypeError: 'NoneType'
    Something is None here: a picture that was not found, descriptors of a picture without
    keypoints, or an outline that was not found. Check before you use it.
AttributeError: 'NoneType'
    Something is None here: a picture that was not found, descriptors of a picture without
    keypoints, or an outline that was not found. Check before you use it.
"""
_ENTRY = re.compile(r"^(\w+):[ ]?(.*)\n((?:    .*\n)+)", re.MULTILINE)
_HINTS = [(kind, part, " ".join(text.split())) for kind, part, text in _ENTRY.findall(_TABLE)]


def hint(kind: str, message: str) -> str:
    """
    Say what an error means, if it is one that students meet often.

    Parameters
    ----------
    kind : str
        The exception's type; OpenCV's own is called ``error``.
    message : str

    Returns
    -------
    str
        A blank and a sentence or two, or nothing.

    Examples
    --------
    >>> hint("error", "OpenCV(5.0.0) resize.cpp:3922: error: (-215) !ssize.empty()")[:20]
    ' A picture is empty:'
    >>> hint("KeyError", "7")
    ''
    """
    for type_, part, meaning in _HINTS:
        if kind == type_ and part in message:
            return f" {meaning}"
    return ""
