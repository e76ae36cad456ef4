"""What students check themselves with, in their notebook or on the command line."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextlib.contextmanager
def when_done() -> Iterator[None]:
    """
    Run the block below, or say kindly what is not written yet.

    Examples
    --------
    >>> with when_done():
    ...     raise NotImplementedError("step 1: load both pictures")
    Not yet: step 1: load both pictures.
    """
    try:
        yield
    except NotImplementedError as error:
        what = str(error).strip().rstrip(".") or "a part of this is not written"
        print(f"Not yet: {what}.")  # noqa: T201
