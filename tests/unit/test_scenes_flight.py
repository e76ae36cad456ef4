"""Held-out flights: what the contract promises, and that the truth is the pixels'."""

from __future__ import annotations

import numpy as np
import pytest

from course_lib import images, scenes


@pytest.mark.parametrize("seed", range(6))
def test_flight_shows_the_well_whole_partly_and_not_at_all(seed):
    frames = scenes.flight(seed).frames
    assert len(frames) == 24
    assert sum(frame.whole for frame in frames) >= 12
    assert sum(frame.polygon is None for frame in frames) >= 4
    assert any(0.3 <= frame.visible < 0.99 for frame in frames)
    stamps = [frame.stamp_ns for frame in frames]
    assert stamps == sorted(set(stamps))
    for frame in frames:
        assert frame.image.shape == (480, 640, 3)
        assert frame.image.dtype == np.uint8
        assert (frame.polygon is None) == (frame.visible < 0.001)
        if frame.polygon is not None:
            assert frame.polygon.dtype == np.float32
            assert (frame.polygon >= 0).all()
            assert (frame.polygon <= [639, 479]).all()


@pytest.mark.parametrize("n_frames", [6, 7, 24, 48])
def test_shares_hold_for_any_length(n_frames):
    frames = scenes.flight(1, n_frames=n_frames).frames
    assert len(frames) == n_frames
    assert 2 * sum(frame.whole for frame in frames) >= n_frames
    assert 6 * sum(frame.polygon is None for frame in frames) >= n_frames


def test_yard_without_well():
    frames = scenes.yard_without_well(5, n_frames=12)
    assert len(frames) == 12
    assert all(frame.polygon is None and frame.visible == 0 for frame in frames)
    assert len({frame.image.tobytes() for frame in frames}) == 12


def test_seeds_differ():
    first, second = scenes.flight(1).frames, scenes.flight(2).frames
    assert not any(np.array_equal(a.image, b.image) for a, b in zip(first, second, strict=True))


@pytest.mark.parametrize("wrong", [5, 49])
def test_wrong_length(wrong):
    with pytest.raises(ValueError, match="n_frames must be at"):
        scenes.flight(0, n_frames=wrong)


def test_missing_pictures_are_named(tmp_path, monkeypatch):
    monkeypatch.setenv(images.FOLDER_VARIABLE, str(tmp_path))
    with pytest.raises(scenes.MissingHeldOutError, match="for grading only"):
        scenes.flight(987_654)
