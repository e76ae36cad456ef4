"""What an error message means in this course, for the errors that students meet most."""

from __future__ import annotations

import re

# An error's type, a part of its message, and below it what it means; the first that fits is taken.
_TABLE = """
error: K == 1 && update == 0
    crossCheck=True leaves at most one match for each keypoint, so knnMatch(…, k=2) is impossible
    with it: cross-check with match(), or use knnMatch and a ratio test without crossCheck.
error: empty()
    A picture is empty: cv2.imread found no picture at that path and returned None.
    images.load("ROS.png") finds the course's pictures wherever the notebook lies.
error: The function is not implemented. Rebuild the library
    cv2.imshow opens a window, and a notebook has none: use drawing.show or matplotlib.
error: scn + 1 == m.cols
    cv2.perspectiveTransform takes points of shape (4, 1, 2), corners.reshape(-1, 1, 2), and a
    homography that is not None: findHomography may find none. Check both before you call it.
error: depth == CV_32F || depth == CV_64F
    cv2.perspectiveTransform takes floats: make the corners an array of np.float32.
error: depth == CV_32F || depth == CV_32S
    cv2.isContourConvex and cv2.contourArea take float32, not float64: corners.astype(np.float32).
error: checkVector(2, CV_32S)
    Drawing takes whole numbers: cv2.polylines(picture, [np.int32(corners)], True, color).
error: Bad number of channels
    This picture is grey already. Convert it once only, either before or in the function.
error: (type == CV_8U && dtype == CV_32S)
    NORM_HAMMING counts bits and takes ORB's descriptors as they are, uint8: were they converted?
    SIFT's are floats, and go with NORM_L2.
error: src1.cols == src2.cols
    One of the two sets of descriptors is None, as that picture has no keypoints. Check first.
error: at least 4 corresponding point sets
    A homography needs four matches: count them first.
error: should be 2D or 3D point sets
    There are no matched points here. A homography needs four matches: count them first.
error: Can't parse 'keypoints
    Keypoints are cv2.KeyPoint objects, as detectAndCompute gives them, not their coordinates.
error: Can't parse 'matches1to2'
    cv2.drawMatches takes a list of matches; cv2.drawMatchesKnn a list of lists, as knnMatch gives.
error: Expected 'filename' to be a str
    cv2.imwrite takes the file's name first, then the picture.
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
ValueError: truth value of an array
    Compare with None by `is`: `if corners is not None`, not `if corners` or `corners != None`.
ValueError: not enough values to unpack (expected 2, got
    knnMatch gives fewer than two neighbours where the other picture has fewer keypoints than that:
    look at len(pair) before you take it apart.
TypeError: cannot unpack non-iterable NoneType
    A function that should return two things returns None: does it end in a return?
TypeError: slice indices must be integers
    A count is an int, and is cut off at one: matches[:int(count)].
AttributeError: object has no attribute 'pt'
    find_keypoints should return cv2.KeyPoint objects, as ORB gives them, not their coordinates.
AttributeError: object has no attribute 'queryIdx'
    knnMatch returns a list for each keypoint: keep the best of each, and return those.
AttributeError: object has no attribute 'distance'
    knnMatch returns a list for each keypoint: compare its two, m and n, and keep m.
TypeError: 'NoneType' object is not subscriptable
    Something is None here: does the function whose result it is end in a return? Else a picture was
    not found, or an outline. Check before you use it.
TypeError: 'NoneType'
    Something is None here: a picture that was not found, descriptors of a picture without
    keypoints, or an outline that was not found. Check before you use it.
TypeError: argument 0 of type NoneType
    Something is None here: an outline that was not found. Check before you draw it.
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
