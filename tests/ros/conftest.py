"""Skips where ROS is not installed; a piece of the flight, and a master to play it to."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from flight_piece import ROOT, Piece, make_piece

from course_lib.real_ros import Ros, complaint


@pytest.fixture(scope="session", autouse=True)
def _installed() -> None:
    if problem := complaint():
        pytest.skip(problem)


@pytest.fixture(scope="session")
def piece(tmp_path_factory: pytest.TempPathFactory) -> Piece:
    return make_piece(tmp_path_factory.mktemp("piece") / "raw.bag")


@pytest.fixture(scope="module")
def ros(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros]:
    """A master for the tests of one file, with nothing but the solutions on its path."""
    with Ros(ROOT / "solutions", home=tmp_path_factory.mktemp("home")) as master:
        yield master
