"""A ROS master of one's own, and what runs on it."""

from __future__ import annotations

import os
import shutil
import socket
import xmlrpc.client
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Self

from course_lib.real_ros.processes import Program, RosError
from course_lib.real_ros.system import complaint, environment

if TYPE_CHECKING:
    from types import TracebackType

_START = 40.0  # seconds; a quiet machine needs one


class Ros:
    """`roscore` on a free port of the loopback address, for as long as the `with` block lasts.

    Parameters
    ----------
    package_path : str or Path, optional
        A folder that holds ROS packages, as `ROS_PACKAGE_PATH` names them.
    home : str or Path, optional
        The folder where nodes run, and where they save what they save; `$(env HOME)` is this folder
        too. Default: a temporary one.
    sim_time : bool, optional
        Whether nodes go by the clock that a recording's player publishes, as `use_sim_time` says.

    Attributes
    ----------
    environment : dict of str to str
        For a program that is to use this master.
    home : Path
    """

    def __init__(
        self,
        package_path: str | Path = ".",
        *,
        home: str | Path | None = None,
        sim_time: bool = False,
    ) -> None:
        self._package_path = Path(package_path)
        self._home = home
        self._sim_time = sim_time
        self._programs: list[Program] = []

    def __enter__(self) -> Self:
        if problem := complaint():
            raise RosError(problem)
        self._folder = TemporaryDirectory(prefix="ros_")
        self.home = Path(self._home or self._folder.name).resolve()
        port = _free_port()
        self.environment = environment(self.home, port, [self._package_path])
        if self._home:
            self.environment["HOME"] = str(self.home)
        self.environment["ROS_LOG_DIR"] = str(Path(self._folder.name, "log"))
        self._call_it_python()
        try:
            core = self.start("roscore", "-p", str(port))
            # The collector of log lines is the last that roscore starts.
            core.wait_for("started core service", _START)
            if self._sim_time:
                self.set_param("/use_sim_time", value=True)
        except BaseException:
            self.close()
            raise
        return self

    def _call_it_python(self) -> None:
        """Let `#!/usr/bin/env python` mean Debian's Python, whose only name is python3.

        Else that line would find the caller's own environment, which has no rospy.
        """
        if shutil.which("python", path="/usr/bin:/bin"):
            return
        programs = Path(self._folder.name, "bin")
        programs.mkdir()
        (programs / "python").symlink_to("/usr/bin/python3")
        self.environment["PATH"] = f"{programs}{os.pathsep}{self.environment['PATH']}"

    def nodes_on(self, topic: str) -> tuple[list[str], list[str]]:
        """Ask the master who publishes on a topic, and who subscribes to it.

        Parameters
        ----------
        topic : str

        Returns
        -------
        publishers, subscribers : list of str
            Names of nodes.
        """
        _, _, (publishers, subscribers, _) = self._master().getSystemState("/course")
        return dict(publishers).get(topic, []), dict(subscribers).get(topic, [])

    def _master(self) -> Any:  # noqa: ANN401  (a proxy answers to any name)
        return xmlrpc.client.ServerProxy(self.environment["ROS_MASTER_URI"])

    def set_param(self, name: str, value: object) -> None:
        """Set a parameter, by its full name."""
        self._master().setParam("/course", name, value)

    def start(self, *command: str, feed: bool = False) -> Program:
        """Start a program on this master.

        Parameters
        ----------
        *command : str
        feed : bool, optional
            Whether it gets a pipe to read from.

        Returns
        -------
        Program
        """
        printed = Path(self._folder.name, f"output_{len(self._programs)}.txt")
        # Found by the PATH that it will have, not by ours.
        found = shutil.which(command[0], path=self.environment["PATH"])
        if found is None:
            raise RosError(f"there is no program {command[0]}")
        program = Program(
            [found, *command[1:]], self.environment, printed, cwd=self.home, feed=feed
        )
        self._programs.append(program)
        return program

    def run(self, *command: str, seconds: float = 60.0) -> str:
        """Run a program to its end.

        Returns
        -------
        str
            What it printed.

        Raises
        ------
        RosError
            When it fails, or takes longer.
        """
        program = self.start(*command)
        if status := program.wait(seconds):
            raise RosError(f"{program.name} ended with status {status}:\n{program.output}")
        return program.output

    def close(self) -> None:
        """End all that was started here, the last first."""
        while self._programs:
            self._programs.pop().end()
        self._folder.cleanup()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
