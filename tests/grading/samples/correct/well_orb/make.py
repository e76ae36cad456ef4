"""One of the packages of `independent_4_2.py`, which the hidden tests are tested with, too."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[3]))
from independent_4_2 import handed_in


def make(folder):
    handed_in("orb", folder)
