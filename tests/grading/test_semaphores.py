"""What `multiprocessing` is given where the system's semaphores are closed to students."""

from __future__ import annotations

import multiprocessing
import threading
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import synchronize

import pytest

from course_lib.grading.sandbox import semaphores

FORK = multiprocessing.get_context("fork")


@pytest.fixture(autouse=True)
def closed(monkeypatch):
    """As under Landlock."""
    monkeypatch.setattr(synchronize, "_multiprocessing", semaphores._Substitute)


def _square(number):
    return number**2


def _count(value):
    for _ in range(200):
        with value.get_lock():
            value.value += 1


def test_pools_work():
    with FORK.Pool(2) as pool:
        assert pool.map(_square, range(9)) == [n**2 for n in range(9)]
    with ProcessPoolExecutor(2, mp_context=FORK) as pool:
        assert list(pool.map(_square, range(9))) == [n**2 for n in range(9)]


def test_a_lock_keeps_processes_apart():
    value = FORK.Value("i", 0)
    children = [FORK.Process(target=_count, args=(value,)) for _ in range(4)]
    for child in children:
        child.start()
    for child in children:
        child.join(20)
    assert value.value == 800


def test_locks_keep_their_rules():
    lock, again, event = FORK.Lock(), FORK.RLock(), FORK.Event()
    with again, again:
        pass
    with lock:
        assert not lock.acquire(timeout=0.01)
        assert not lock.acquire(block=False)
    with pytest.raises(ValueError, match="too many"):
        lock.release()
    with pytest.raises(AssertionError, match="not owned"):
        again.release()
    assert not event.wait(0.01)
    threading.Timer(0.05, event.set).start()
    assert event.wait(10)
