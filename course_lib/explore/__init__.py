"""Interactive viewers: the kernel computes once, the browser filters and draws.

Every viewer is an `ipywidgets.VBox`: sliders linked in the browser (`jslink`) to a canvas that
holds all of its data, so a change never waits for the kernel, and exported pages need none.
"""

from course_lib.explore._fast import fast

__all__ = ["fast"]
