"""Exercise 4.1 as different people would write it, each without having seen another's."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).with_name("samples")))
import build

AUTHORS = ("tutorial", "sift_ratio_magsac", "class_based", "careful", "second_tutorial")

STUB = [
    '''def load_images():
    """Return the mug, 400 wide and 600 high, and the scene, 600 wide and 400 high."""
    raise NotImplementedError("read both pictures and resize them")''',
    '''def find_keypoints(image):
    """Return the keypoints and descriptors that ORB finds."""
    raise NotImplementedError("convert to gray, then detectAndCompute")''',
    '''def match_keypoints(query_descriptors, train_descriptors):
    """Return the cross-checked matches, best first."""
    raise NotImplementedError("BFMatcher, then sort")''',
    '''def locate_mug(mug, scene, match_count=100):
    """Return the mug's corners in the scene, or None."""
    raise NotImplementedError("findHomography, then perspectiveTransform")''',
]


def _cells(author: str) -> list[str]:
    script = build.HERE / "correct" / author / "exercise_4_1.py"
    return [cell.source for cell in build.notebook(script.read_text(encoding="utf-8")).cells]


SOLUTIONS = {author: _cells(author) for author in AUTHORS}
