"""Rules for every test run: in strict mode (CI) a skipped test is a failure."""

from __future__ import annotations

import os
import signal

import pytest
from hypothesis import settings

# How long an example takes says more about the machine than about the code.
settings.register_profile("course", deadline=None)
settings.load_profile("course")

# What a shell starts in the background ignores Ctrl-C, and what it starts does too: then the tests
# that interrupt a program would wait for nothing.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

collect_ignore = ["hidden", "grading/quick_hidden"]  # these run inside the grader


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Fail a strict run in which anything was skipped.

    Under xdist the workers' reports arrive at the controller, so only it decides.
    """
    if os.environ.get("COURSE_STRICT") != "1" or hasattr(session.config, "workerinput"):
        return
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    skipped = reporter.stats.get("skipped", [])
    if skipped:
        reporter.write_line(f"COURSE_STRICT=1: {len(skipped)} skipped, which CI forbids", red=True)
        if session.exitstatus == 0:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED
