"""Which sandbox works on this machine."""

from __future__ import annotations

import importlib.util

from course_lib.grading.sandbox import bubblewrap

NAMES = ("bubblewrap", "sandlock", "none")


class SandboxError(RuntimeError):
    """The sandbox itself failed; not the submission's fault."""


class LimitError(RuntimeError):
    """A submission exceeded a limit before its kernel was ready: no fault of the sandbox."""


class NoSandboxError(RuntimeError):
    """Nothing here can hold a stranger's code."""


def choose(name: str | None = None) -> str:
    """Choose a sandbox that works on this machine.

    Parameters
    ----------
    name : str, optional
        ``"bubblewrap"``, ``"sandlock"``, or ``"none"`` for code that you trust. Default: the first
        of the two that works.

    Returns
    -------
    str
        Its name.

    Raises
    ------
    NoSandboxError
        When it does not work here; says what to install.
    ValueError
        For an unknown name.
    """
    if name == "none":
        return name
    if name is not None and name not in NAMES:
        raise ValueError(f"unknown sandbox {name!r}; there are {', '.join(NAMES)}")
    complaints = []
    for candidate in [name] if name else NAMES[:2]:
        complaint = bubblewrap.complaint() if candidate == "bubblewrap" else _sandlock_complaint()
        if complaint is None:
            return candidate
        complaints.append(complaint)
    raise NoSandboxError(
        "No sandbox for students' code: " + "; ".join(complaints) + ". "
        "Install bubblewrap (Debian: apt install bubblewrap), or, only for code that you trust, "
        "give --no-sandbox."
    )


def _sandlock_complaint() -> str | None:
    if importlib.util.find_spec("sandlock") is None:
        return "sandlock is not installed (pip install sandlock)"
    import sandlock  # noqa: PLC0415

    if sandlock.landlock_abi_version() < sandlock.min_landlock_abi():
        return f"sandlock needs Landlock version {sandlock.min_landlock_abi()} in the Linux kernel"
    return None
