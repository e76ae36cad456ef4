"""A real JupyterLab and Debian's Chromium, started once for all browser tests."""

from __future__ import annotations

import contextlib
import json
import os
import re
import secrets
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

ROOT = Path(__file__).resolve().parents[2]
CHROMIUM = shutil.which("chromium")
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
# Not ours: JupyterLab's own remarks on a fresh profile.
HARMLESS = re.compile(
    r"favicon|sourcemap|source map|Download the React DevTools|/api/contents.*404"
)


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed; `make system` installs it")
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield running
        running.close()


@dataclass
class Lab:
    """A running JupyterLab.

    Attributes
    ----------
    address : str
        Without the token.
    token : str
    root : Path
        The folder it serves.
    """

    address: str
    token: str
    root: Path
    errors: list[str] = field(default_factory=list)

    def url(self, notebook: str) -> str:
        return f"{self.address}/lab/tree/{notebook}?token={self.token}&reset"


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextlib.contextmanager
def running_lab(root: Path, scratch: Path) -> Iterator[Lab]:
    """Serve a folder with JupyterLab, with settings of its own, and end it with its kernels."""
    port, token = _free_port(), secrets.token_hex(8)
    labconfig = scratch / "config" / "labconfig"
    labconfig.mkdir(parents=True)
    # On a busy machine JupyterLab's splash screen may remove itself twice, an error in the console.
    splash = {"disabledExtensions": {"@jupyterlab/apputils-extension:splash": True}}
    (labconfig / "page_config.json").write_text(json.dumps(splash))
    environment = os.environ | {
        "JUPYTER_CONFIG_DIR": str(scratch / "config"),
        "JUPYTER_DATA_DIR": str(scratch / "data"),
        "JUPYTER_RUNTIME_DIR": str(scratch / "runtime"),
        "JUPYTERLAB_SETTINGS_DIR": str(scratch / "settings"),
        "JUPYTERLAB_WORKSPACES_DIR": str(scratch / "workspaces"),
        "PYTHONPATH": str(ROOT),
        "COURSE_IMAGES": os.environ.get("COURSE_IMAGES", str(ROOT / "images")),
    }
    command = [
        *(sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root"),
        *(f"--port={port}", "--ServerApp.port_retries=0", f"--IdentityProvider.token={token}"),
        *(f"--ServerApp.root_dir={root}", "--expose-app-in-browser"),
    ]
    log = (scratch / "lab.log").open("w")
    server = subprocess.Popen(command, env=environment, stdout=log, stderr=log)
    try:
        address = f"http://127.0.0.1:{port}"
        for _ in range(1200):
            if server.poll() is not None:
                raise RuntimeError((scratch / "lab.log").read_text()[-2000:])
            with contextlib.suppress(OSError):
                urllib.request.urlopen(f"{address}/api?token={token}", timeout=1).close()
                break
            time.sleep(0.1)
        yield Lab(address, token, root)
    finally:
        server.terminate()
        try:
            server.wait(15)
        except subprocess.TimeoutExpired:
            server.kill()
            server.wait()
        log.close()


@pytest.fixture(scope="session")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    """Serve a copy of the course, so that a test never changes a stored notebook."""
    root = tmp_path_factory.mktemp("course")
    for part in ("notebooks", "solutions"):
        if (ROOT / part).is_dir():
            shutil.copytree(ROOT / part, root / part)
    with running_lab(root, tmp_path_factory.mktemp("lab")) as server:
        yield server


def watch_console(page: Page) -> list[str]:
    """Collect the page's errors."""
    seen: list[str] = []

    def note(text: str) -> None:
        if not HARMLESS.search(text):
            seen.append(text)

    page.on("console", lambda m: note(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: note(str(error)))
    return seen


def run_all(page: Page, lab: Lab, notebook: str, *, seconds: float = 60) -> None:
    """Open a notebook in JupyterLab and run every cell, and wait until the kernel is idle."""
    page.goto(lab.url(notebook))
    page.wait_for_function("() => window.jupyterapp?.shell.currentWidget?.context?.isReady")
    page.evaluate(
        """async () => {
          const panel = window.jupyterapp.shell.currentWidget;
          await panel.context.ready;
          await panel.context.sessionContext.ready;
          await window.jupyterapp.commands.execute("notebook:run-all-cells");
        }"""
    )
    page.wait_for_function(
        """() => window.jupyterapp.shell.currentWidget.content.model.sharedModel.cells
              .filter((c) => c.cell_type === "code" && c.source.trim())
              .every((c) => c.execution_count > 0)""",
        timeout=1000 * seconds,
    )


@pytest.fixture
def page(browser: Browser) -> Iterator[Any]:
    """A fresh page; the test fails when it logged an error."""
    context = browser.new_context(viewport={"width": 1300, "height": 1000})
    fresh = context.new_page()
    errors = watch_console(fresh)
    yield fresh
    context.close()
    assert errors == []
