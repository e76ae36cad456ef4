"""What one submission may use."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """What one submission may use, in seconds and bytes.

    Attributes
    ----------
    wall_s : float
        For the whole submission.
    cell_s, call_s : float
        For one cell of the notebook, for one call of a hidden test.
    cpu_s : float
        Processor seconds of all its processes together.
    memory_bytes : int
        Memory of all its processes together.
    processes : int
        Processes and threads at one time.
    file_bytes, disk_bytes : int
        One file, and all files together.
    output_bytes : int
        What it may print and draw.
    open_files : int
        File descriptors of one process.
    """

    wall_s: float = 300.0
    cell_s: float = 60.0
    call_s: float = 20.0
    cpu_s: float = 300.0
    memory_bytes: int = 2 * 2**30
    processes: int = 64
    file_bytes: int = 64 * 2**20
    disk_bytes: int = 256 * 2**20
    output_bytes: int = 32 * 2**20
    open_files: int = 256
