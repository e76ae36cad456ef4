"""The cockpit: fly the simulated drone with keys or sliders while the object is outlined live."""

from __future__ import annotations

import contextvars
import json
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from traitlets import Float, Unicode

from course_lib.explore._base import Canvas, Viewer, colour_picture, jpeg, link, module, slider
from course_lib.explore._still import caption
from course_lib.localize import TemplateLocator

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from concurrent.futures import Future

    from numpy.typing import NDArray

    from course_lib.camera import Frame
    from course_lib.drone import Drone

WIDTH, HEIGHT = 640, 480
COMMANDS = ("vx", "vy", "vz", "yaw")
MOST_OWED = 20  # frames, so that a browser that has gone is not sent pictures for ever
LONGEST = 0.25  # seconds that pass between two frames at most, however slow the machine
FOUND_BGR, TRUE_BGR = (94, 197, 34), (250, 165, 96)


class FlyCanvas(Canvas):
    """What the drone sees; the browser asks for frames, and nobody works when it does not."""

    _esm = module("fly")

    vx = Float().tag(sync=True)
    vy = Float().tag(sync=True)
    vz = Float().tag(sync=True)
    yaw = Float().tag(sync=True)
    first = Unicode().tag(sync=True)


class Cockpit:
    """Answers the browser's questions: flies on, takes a picture, looks for the object.

    While the object is looked for in one picture, the next is drawn on the other processor. So a
    command is seen one picture later, and there are half as many again in a second.

    Parameters
    ----------
    drone : Drone
    locator : TemplateLocator
    """

    def __init__(self, drone: Drone, locator: TemplateLocator) -> None:
        self._drone = drone
        self._locator = locator
        self._last = 0.0
        self._camera = ThreadPoolExecutor(1, thread_name_prefix="cockpit")
        self._next: Future[tuple[Frame, str]] | None = None
        self._lock = threading.Lock()  # JupyterLab may answer from several threads

    def answer(self, command: Mapping[str, float]) -> tuple[dict[str, Any], NDArray[np.uint8]]:
        """Follow a command for the time since the last frame.

        Parameters
        ----------
        command : mapping
            `vx`, `vy`, `vz` in m/s, `yaw` in rad/s.

        Returns
        -------
        about : dict
            `corners`, eight numbers or none; `well`, the true outline; `text`.
        image : ndarray of uint8, shape (480, 640, 3)
            BGR.
        """
        with self._lock:
            return self._answer(command)

    def _answer(self, command: Mapping[str, float]) -> tuple[dict[str, Any], NDArray[np.uint8]]:
        now = time.monotonic()
        elapsed, self._last = min(now - self._last, LONGEST), now
        # The drone is touched by one thread at a time: the last picture is done before it moves.
        frame, where = self._next.result() if self._next else self._look()
        self._drone.command(*(float(command.get(name, 0.0)) for name in COMMANDS))
        self._drone.step(elapsed)
        self._next = self._camera.submit(self._look)
        detection = self._locator.locate(frame.image)
        truth = (frame.truth or {})["well"]
        found = f"found, {detection.inlier_count} inliers" if detection else "not found"
        corners = detection.corners
        about = {
            "corners": [] if corners is None else np.round(corners.ravel(), 1).tolist(),
            "well": [value for point in truth["polygon"] for value in point],
            "text": f"{where}; {found}.",
        }
        return about, frame.image

    def _look(self) -> tuple[Frame, str]:
        x, y, z = self._drone.position
        return self._drone.frame(), f"{np.hypot(x, y):.1f} m from the well, {z:.1f} m up"


class Stream:
    """Sends as many frames as the browser has asked for last, beside whatever else the kernel does.

    A request for each frame would cost more than the frame: JupyterLab draws its toolbar anew
    whenever the kernel is busy with a message, and when it is idle again.

    Parameters
    ----------
    cockpit : Cockpit
    send : callable
        Sends what is said about a frame, and its picture as a JPEG file.
    """

    def __init__(self, cockpit: Cockpit, send: Callable[[dict[str, Any], bytes], None]) -> None:
        self._cockpit = cockpit
        self._send = send
        self._command: Mapping[str, float] = {}
        self._owed = 0
        self._running = False
        self._lock = threading.Lock()

    def ask(self, command: Mapping[str, float], frames: int) -> None:
        """Follow another command, and owe so many frames from now on."""
        with self._lock:
            self._command, self._owed = command, min(frames, MOST_OWED)
            if self._running or self._owed < 1:
                return
            self._running = True
        # Messages from another thread still need to say which request they answer.
        context = contextvars.copy_context()
        threading.Thread(target=context.run, args=(self._run,), daemon=True).start()

    def _run(self) -> None:
        while (command := self._next()) is not None:
            try:
                about, image = self._cockpit.answer(command)
                self._send(about, jpeg(image, 80))
            except BaseException:
                with self._lock:
                    self._running = False
                raise

    def _next(self) -> Mapping[str, float] | None:
        with self._lock:
            if self._owed < 1:
                self._running = False
                return None
            self._owed -= 1
            return self._command


def fly(
    drone: Drone,
    template: NDArray[np.uint8],
    *,
    match_count: int = 100,
    alt: str | None = None,
) -> Viewer:
    """Fly the simulated drone while an object is outlined in what it sees.

    Four sliders set the velocity; on the picture itself the keys W A S D, the arrows, R and F do,
    and the space bar stops. The browser asks the kernel for a few frames at a time while the drone
    is commanded and for a moment after; otherwise nothing runs.

    Parameters
    ----------
    drone : Drone
        It flies on from where it is, and stays open.
    template : ndarray of uint8, shape (H, W, 3)
        The object, BGR.
    match_count : int
        As for `TemplateLocator`.
    alt : str or None
        Text alternative of the viewer.

    Returns
    -------
    Viewer
    """
    cockpit = Cockpit(
        drone, TemplateLocator(colour_picture(template, "template"), match_count=match_count)
    )
    about, image = cockpit.answer({})
    seen = "outlined" if about["corners"] else "not found"
    alt = alt or f"What the simulated drone sees before it starts: the yard, the object {seen}."
    canvas = FlyCanvas(
        picture=jpeg(image, 80),
        width=WIDTH,
        height=HEIGHT,
        alt=f"{alt} Press W, A, S, D, the arrows, R or F to fly, space to stop.",
        first=json.dumps(about),
    )

    stream = Stream(cockpit, lambda about, data: canvas.send({"kind": "frame", **about}, [data]))

    def reply(_canvas: FlyCanvas, message: Mapping[str, Any], _buffers: object) -> None:
        if message.get("kind") == "look":
            stream.ask(message.get("command", {}), int(message.get("frames", 1)))

    canvas.on_msg(reply)
    controls = [
        slider("forward (m/s)", 0.0, -1.5, 1.5, 0.1),
        slider("left (m/s)", 0.0, -1.5, 1.5, 0.1),
        slider("up (m/s)", 0.0, -0.8, 0.8, 0.1),
        slider("turn left (rad/s)", 0.0, -1.0, 1.0, 0.1),
    ]
    for control, name in zip(controls, COMMANDS, strict=True):
        link(control, canvas, name)
    # Without the sensor's noise the stored picture needs fewer colours.
    calm = np.asarray(cv2.bilateralFilter(image, 5, 30, 3), np.uint8)
    still = np.asarray(cv2.resize(_draw(calm, about), (480, 360), interpolation=cv2.INTER_AREA))
    still = caption(np.asarray(still, np.uint8), f"{alt} Run the notebook to fly.")
    return Viewer([*controls, canvas], still=still, alt=alt)


def _draw(image: NDArray[np.uint8], about: Mapping[str, Any]) -> NDArray[np.uint8]:
    still = image.copy()
    for name, ink, width in (("well", TRUE_BGR, 1), ("corners", FOUND_BGR, 3)):
        if about[name]:
            outline = np.rint(np.reshape(about[name], (-1, 2))).astype(np.int32)
            cv2.polylines(still, [outline], isClosed=True, color=ink, thickness=width)
    return still
