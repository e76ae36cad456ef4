"""The file with the instructor's secret: where it may lie, and how it is made."""

from __future__ import annotations

import os
import secrets
import stat
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

FEWEST_BYTES = 16
_MOST_BYTES = 1 << 16


class SeedFileError(ValueError):
    """The seed file cannot be used; the message says why and what to do."""


def usual_path() -> Path:
    """Give the path of the seed file when none is named.

    Returns
    -------
    Path
        In the user's own folder of settings.
    """
    settings = os.environ.get("XDG_CONFIG_HOME", "")
    base = Path(settings) if Path(settings).is_absolute() else Path.home() / ".config"
    return base / "feature-matching" / "seed"


def read(path: Path, *, forbidden: Iterable[Path] = ()) -> bytes:
    """Read the secret.

    Parameters
    ----------
    path : Path
        The seed file.
    forbidden : iterable of Path
        Folders that are handed in, handed out or published: it must lie in none of them, nor in a
        git work tree.

    Returns
    -------
    bytes
        At least 16.

    Raises
    ------
    SeedFileError
        When it lies where others will see it, is missing, or holds too little.
    """
    _check_place(path, forbidden)
    try:
        with path.open("rb") as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise SeedFileError(f"the seed file {path} is not a regular file")
            secret = file.read(_MOST_BYTES + 1)
    except FileNotFoundError:
        raise SeedFileError(f"there is no seed file {path}") from None
    except OSError as error:
        raise SeedFileError(f"the seed file {path} cannot be read: {error.strerror}") from error
    if len(secret.strip()) < FEWEST_BYTES or len(secret) > _MOST_BYTES:
        raise SeedFileError(
            f"the seed file {path} must hold from {FEWEST_BYTES} to {_MOST_BYTES} bytes; make one "
            f"with: head -c 32 /dev/urandom > {path}"
        )
    return secret


def make(path: Path, *, forbidden: Iterable[Path] = ()) -> bool:
    """Make a seed file that only its owner may read, unless there is one.

    Parameters
    ----------
    path : Path
    forbidden : iterable of Path
        As for `read`.

    Returns
    -------
    bool
        Whether it was made.

    Raises
    ------
    SeedFileError
        When it must not lie there, or cannot be written.
    """
    _check_place(path, forbidden)
    try:
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        # Never half a file: what was killed while writing is made anew under its own name.
        part = path.with_name(f".seed.{os.getpid()}")
        with os.fdopen(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "wb") as file:
            file.write(secrets.token_hex(32).encode() + b"\n")
            file.flush()
            os.fsync(file.fileno())
        try:
            os.link(part, path)  # fails if somebody was quicker, who then has made the only one
        except FileExistsError:
            return False
        finally:
            part.unlink()
    except OSError as error:
        raise SeedFileError(f"no seed file can be made at {path}: {error.strerror}") from error
    return True


def readable_by_others(path: Path) -> bool:
    """Tell whether other users of this machine may read the file."""
    return bool(path.stat().st_mode & (stat.S_IRGRP | stat.S_IROTH))


def _check_place(path: Path, forbidden: Iterable[Path]) -> None:
    advice = "Keep it elsewhere: whoever has it can make the hidden tests' inputs."
    for real in {path.resolve(), Path(os.path.abspath(path))}:  # noqa: PTH100  (links as they are named)
        for folder in forbidden:
            if real.is_relative_to(folder.resolve()):
                raise SeedFileError(f"the seed file {path} lies in {folder}. {advice}")
        for parent in real.parents:
            if (parent / ".git").exists():
                raise SeedFileError(
                    f"the seed file {path} lies in the git work tree {parent}. {advice}"
                )
