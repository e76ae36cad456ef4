"""Interactive viewers: the kernel computes once, the browser filters and draws.

Every viewer is an `ipywidgets.VBox`: sliders linked in the browser (`jslink`) to a canvas that
holds all of its data, so a change never waits for the kernel, and exported pages need none. The
one exception is `fly`, whose pictures a simulator draws while one flies.
"""

from course_lib.explore._brief import brief_pairs
from course_lib.explore._fast import fast
from course_lib.explore._flight import flight
from course_lib.explore._fly import fly
from course_lib.explore._magnifier import fast_magnifier
from course_lib.explore._matches import matches, ransac

__all__ = ["brief_pairs", "fast", "fast_magnifier", "flight", "fly", "matches", "ransac"]
