"""The bag that most of these tests play."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from synthetic_bag import frame, write_bag

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="session")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twenty pictures, ten per second."""
    return write_bag(tmp_path_factory.mktemp("bags") / "short.bag", [frame(i) for i in range(20)])
