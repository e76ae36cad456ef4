"""Held-out scenes and flights with exact truth, made from a seed."""

from __future__ import annotations

from course_lib.scenes.flights import Flight, HeldOutFrame, flight, yard_without_well
from course_lib.scenes.heldout import MissingHeldOutError
from course_lib.scenes.mugs import KINDS, MugScene, mug_scene

__all__ = [
    "KINDS",
    "Flight",
    "HeldOutFrame",
    "MissingHeldOutError",
    "MugScene",
    "flight",
    "mug_scene",
    "yard_without_well",
]
