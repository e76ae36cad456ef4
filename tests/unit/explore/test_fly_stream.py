"""Frames come when they are owed, with the newest command, and from one thread at a time."""

from __future__ import annotations

import threading
import time
from typing import Any

import numpy as np
import pytest

from course_lib.explore._fly import MOST_OWED, Stream

IMAGE = np.zeros((4, 6, 3), np.uint8)


class Recorder:
    """A cockpit that tells which commands it was given, and takes a moment for each."""

    def __init__(self) -> None:
        self.commands: list[Any] = []
        self.sent: list[bytes] = []
        self.at_once = 0
        self.gate = threading.Event()
        self.gate.set()

    def answer(self, command: Any) -> tuple[dict[str, Any], Any]:
        self.at_once += 1
        assert self.at_once == 1
        self.gate.wait(10)
        self.commands.append(command)
        self.at_once -= 1
        return {}, IMAGE

    def send(self, _about: dict[str, Any], data: bytes) -> None:
        self.sent.append(data)


@pytest.fixture
def flown() -> tuple[Recorder, Stream]:
    recorder = Recorder()
    return recorder, Stream(recorder, recorder.send)  # type: ignore[arg-type]


def settle(stream: Stream) -> None:
    deadline = time.monotonic() + 10
    while stream._running and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not stream._running


def test_as_many_frames_as_are_owed(flown: tuple[Recorder, Stream]) -> None:
    recorder, stream = flown
    stream.ask({"vx": 1.0}, 3)
    settle(stream)
    assert recorder.commands == [{"vx": 1.0}] * 3
    assert all(data.startswith(b"\xff\xd8") for data in recorder.sent)
    stream.ask({"vx": 2.0}, 1)  # and again, once it has rested
    settle(stream)
    assert len(recorder.sent) == 4


def test_a_new_command_is_followed_at_once_and_renews_what_is_owed(
    flown: tuple[Recorder, Stream],
) -> None:
    recorder, stream = flown
    recorder.gate.clear()
    stream.ask({"vx": 1.0}, 5)
    time.sleep(0.05)
    stream.ask({"vx": 2.0}, 2)
    recorder.gate.set()
    settle(stream)
    assert recorder.commands == [{"vx": 1.0}, {"vx": 2.0}, {"vx": 2.0}]


@pytest.mark.parametrize(("frames", "sent"), [(0, 0), (-4, 0), (10**9, MOST_OWED)])
def test_no_request_is_endless(flown: tuple[Recorder, Stream], frames: int, sent: int) -> None:
    recorder, stream = flown
    stream.ask({}, frames)
    settle(stream)
    assert len(recorder.sent) == sent


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_it_goes_on_after_a_frame_that_failed(flown: tuple[Recorder, Stream]) -> None:
    recorder, stream = flown

    def fail(_command: Any) -> Any:
        raise ValueError("this camera is closed")

    answer, recorder.answer = recorder.answer, fail  # type: ignore[method-assign]
    stream.ask({}, 3)
    settle(stream)
    recorder.answer = answer  # type: ignore[method-assign]
    stream.ask({}, 2)
    settle(stream)
    assert len(recorder.sent) == 2
