"""OpenCV's windows, for a node that has no screen.

The headless build of OpenCV raises on `cv2.imshow`. Here the last picture of each window is
kept instead; with nobody to press a key, `cv2.waitKey` gives -1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from course_lib.offline_ros.errors import UnsupportedError
from course_lib.offline_ros.messages import message_class
from course_lib.offline_ros.recorder import WINDOWS, Recorder
from course_lib.offline_ros.times import Time

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from course_lib.offline_ros.runtime import Runtime


class Windows:
    """The windows of one node.

    Parameters
    ----------
    runtime : Runtime
        The node's runtime; `waitKey` lets its time pass.
    """

    def __init__(self, runtime: Runtime) -> None:
        self._runtime = runtime
        self._shown: dict[str, tuple[int, NDArray[Any]]] = {}
        self._sliders: dict[tuple[str, str], int] = {}

    def install(self) -> None:
        """Replace the window functions of `cv2`, in this process only."""
        ignored = (
            "createButton destroyAllWindows destroyWindow moveWindow namedWindow resizeWindow "
            "setMouseCallback setTrackbarMax setTrackbarMin setWindowProperty setWindowTitle "
            "startWindowThread"
        )
        replaced: dict[str, Callable[..., Any]] = {
            **dict.fromkeys(ignored.split(), _ignore),
            "imshow": self.imshow,
            "waitKey": self.wait_key,
            "waitKeyEx": self.wait_key,
            "pollKey": lambda: self.wait_key(1),
            "createTrackbar": self.create_trackbar,
            "getTrackbarPos": lambda name, window: self._sliders.get((window, name), 0),
            "setTrackbarPos": lambda name, window, pos: self._sliders.update({(window, name): pos}),
            "getWindowProperty": lambda _window, _property: 1.0,
            "selectROI": _refuse("cv2.selectROI"),
            "selectROIs": _refuse("cv2.selectROIs"),
        }
        for name, function in replaced.items():
            setattr(cv2, name, function)

    def imshow(self, winname: str, mat: NDArray[Any]) -> None:
        """Keep the picture as the window's last one."""
        if not isinstance(mat, np.ndarray) or not mat.size:
            msg = f"cv2.imshow({winname!r}): there is no picture to show, but {type(mat).__name__}"
            raise cv2.error(msg)
        self._shown[winname] = (self._runtime.now_ns(), mat.copy())

    def wait_key(self, delay: int = 0) -> int:
        """Let simulated time pass; no key is ever pressed.

        Within a callback no time passes: the next message is not to overtake this one.
        """
        if delay > 0 and self._runtime.initialized and not self._runtime.in_callback:
            self._runtime.run_until(self._runtime.now_ns() + delay * 1_000_000)
        return -1

    def create_trackbar(
        self, name: str, window: str, value: int, _count: int, _on_change: object = None
    ) -> None:
        """Remember where the slider stands; nobody moves it."""
        self._sliders[window, name] = value or 0

    def record(self, recorder: Recorder) -> None:
        """Write each window's last picture to the recording, as PNG."""
        for name, (stamp_ns, picture) in self._shown.items():
            # As imshow: 16 bit divided by 256, floats from 0..1.
            if picture.dtype == np.uint16:
                picture = picture // 256  # noqa: PLW2901
            elif picture.dtype.kind == "f":
                picture = np.clip(picture * 255, 0, 255)  # noqa: PLW2901
            written, data = cv2.imencode(".png", picture.astype(np.uint8))
            if written:
                message = message_class("sensor_msgs/CompressedImage")(
                    format="png", data=data.tobytes()
                )
                message.header.frame_id = name
                message.header.stamp = Time.from_nsec(stamp_ns)
                recorder.write_message(WINDOWS, stamp_ns, message)


def _ignore(*_args: object, **_kwargs: object) -> None:
    pass


def _refuse(name: str) -> Callable[..., None]:
    def refuse(*_args: object, **_kwargs: object) -> None:
        raise UnsupportedError(name, "there is nobody to draw with the mouse; use fixed numbers")

    return refuse
