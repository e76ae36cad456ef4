"""The yard that the drone flies in: its parts and textures, its light, its outlines.

`world` is renderer-neutral data. The recorded flights were rendered from it with Blender
(`images/render/yard.py`); `course_lib.drone` builds the same yard in MuJoCo.
"""
