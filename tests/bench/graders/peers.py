"""The other graders, each in an environment of its own that is made when it is first wanted."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from graders import usage

if TYPE_CHECKING:
    from graders.usage import Spent

ROOT = Path(__file__).resolve().parents[3]
SAME = ("numpy", "opencv-contrib-python-headless", "ipykernel")  # in the versions of ours


@dataclass(frozen=True)
class Peer:
    """A grader from the package index.

    Attributes
    ----------
    package, version : str
    command : str
        What it installs.
    """

    package: str
    version: str
    command: str

    @property
    def folder(self) -> Path:
        return ROOT / f".venv-peers-{self.command}"

    @property
    def program(self) -> Path:
        return self.folder / "bin" / self.command

    def run(self, *arguments: str | Path, folder: Path) -> Spent:
        """Run and measure it; it finds its helpers by the path."""
        path = f"{self.program.parent}{os.pathsep}{os.environ['PATH']}"
        return usage.run([self.program, *arguments], folder, env={"PATH": path})

    def install(self) -> None:
        """Make the environment, unless it is there with these versions."""
        wanted = [f"{self.package}=={self.version}", *(f"{name}=={version(name)}" for name in SAME)]
        stamp = self.folder / ".ready"
        if stamp.exists() and stamp.read_text().split() == wanted:
            return
        print(f"making {self.folder.name} (once, some minutes) ...", file=sys.stderr, flush=True)
        subprocess.run([sys.executable, "-m", "venv", "--clear", self.folder], check=True)
        pip = [self.folder / "bin" / "python", "-m", "pip", "--disable-pip-version-check"]
        subprocess.run([*pip, "install", "--quiet", *wanted], check=True)
        stamp.write_text("\n".join(wanted))


NBGRADER = Peer("nbgrader", "0.9.6", "nbgrader")
OTTER = Peer("otter-grader", "7.0.0", "otter")
