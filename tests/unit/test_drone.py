"""The simulated drone: its truth agrees with its pixels, it obeys, it stops at what is solid."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import cv2
import numpy as np
import pytest

from course_lib import camera, images, localize
from course_lib.drone import Drone, RendererError, why_not
from course_lib.yard import backend
from course_lib.yard.eye import Eye
from course_lib.yard.flying import LAG

pytestmark = pytest.mark.skipif(bool(why_not()), reason=why_not())

PLACES = [(-1.6, -7.4, 1.6), (1.5, -5.0, 2.2), (3.5, -3.5, 1.2), (-4.5, -2.0, 2.8)]


@pytest.fixture(scope="module")
def eye() -> Iterator[Eye]:
    made = Eye()
    yield made
    made.close()


@pytest.fixture(scope="module")
def recorded() -> list[Any]:
    with camera.open_camera("flight.bag") as flight:
        return list(flight)


def filled(polygon: Any) -> np.ndarray:
    outline = np.asarray(polygon, np.int32).reshape(-1, 2)
    return cv2.fillPoly(np.zeros((480, 640), np.uint8), [outline], 1) > 0


def outer(mask: np.ndarray) -> np.ndarray:
    """The mask's largest piece without its holes, which the truth's outline does not have."""
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return filled(max(contours, key=cv2.contourArea))


def iou(a: np.ndarray, b: np.ndarray) -> float:
    return float((a & b).sum() / (a | b).sum())


@pytest.mark.parametrize("position", PLACES)
def test_truth_is_where_the_renderer_draws_the_well(
    eye: Eye, position: tuple[float, float, float]
) -> None:
    with Drone(seed=3, position=position) as drone:
        drone.command(vx=0.4, yaw_rate=0.1)
        drone.step(0.5)  # it leans and sways: a pose with all of its six numbers
        truth = drone.frame().truth
    assert truth
    polygon = np.array(truth["well"]["polygon"])
    drawn = outer(eye.well_mask(np.array(truth["T_camera_from_world"])))
    assert iou(filled(polygon), drawn) > 0.97
    assert iou(filled(polygon + [4, 0]), drawn) < 0.97
    assert iou(filled(polygon + [0, 4]), drawn) < 0.97
    assert iou(filled([639, 0] + polygon * [-1, 1]), drawn) < 0.9


def test_a_recorded_pose_gives_the_recorded_picture(eye: Eye, recorded: list[Any]) -> None:
    window = cv2.createHanningWindow((640, 480), cv2.CV_32F)
    for frame in (recorded[i] for i in (10, 60, 160, 190, 240)):
        T = np.array(frame.truth["T_camera_from_world"])
        assert iou(filled(frame.truth["well"]["polygon"]), outer(eye.well_mask(T))) > 0.97
        seen, kept = (
            cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(np.float32)
            for image in (eye.look(T), frame.image)
        )
        shift, response = cv2.phaseCorrelate(seen, kept, window)
        assert np.hypot(*shift) < 0.7
        assert response > 0.15
        mirrored, _ = cv2.phaseCorrelate(np.fliplr(seen).copy(), kept, window)
        assert np.hypot(*mirrored) > 2


def test_camera_is_the_recorded_one(recorded: list[Any]) -> None:
    with Drone() as drone:
        frame = drone.frame()
    assert frame.truth
    assert frame.image.shape == recorded[0].image.shape
    K = images.truth("flight.bag")["camera"]["K"]
    assert np.allclose(frame.truth["camera"]["K"], K, atol=1e-5)
    assert set(recorded[0].truth) <= set(frame.truth)
    assert set(recorded[0].truth["well"]) == set(frame.truth["well"])


def test_well_out_of_sight_has_no_outline() -> None:
    with Drone(heading=-np.pi / 2) as drone:
        truth = drone.frame().truth
    assert truth
    assert truth["well"] == {"polygon": [], "visible": 0.0}


def flown(seed: int) -> list[Any]:
    with Drone(seed=seed) as drone:
        drone.command(0.7, 0.1, 0.05, 0.2)
        frames = []
        for _ in range(3):
            drone.step(0.1)
            frames.append(drone.frame())
        return frames


def test_same_seed_same_flight() -> None:
    first, again, other = flown(1), flown(1), flown(2)
    for a, b in zip(first, again, strict=True):
        assert a.stamp_ns == b.stamp_ns
        assert a.truth == b.truth
        assert np.array_equal(a.image, b.image)
    assert first[0].truth != other[0].truth


def test_commands_are_in_the_drones_axes() -> None:
    with Drone(position=(0.0, -6.0, 2.0), heading=np.pi / 2) as drone:
        start = drone.position
        drone.command(vx=1.0)
        drone.step(LAG)
        assert drone.velocity[0] == pytest.approx(1 - np.exp(-1), abs=0.03)
        drone.step(2)
        moved = drone.position - start
        assert moved[1] > 1.5
        assert abs(moved[0]) < 0.01
        drone.command(yaw_rate=0.5)
        drone.step(2)
        assert drone.heading > np.pi / 2 + 0.7  # turned left
        drone.command()
        drone.step(2)
        x = drone.position[0]
        drone.command(vy=0.5, vz=0.3)
        drone.step(1)
        assert drone.position[0] < x  # left of north is west, and more so after the turn
        assert drone.position[2] > 2.1


def test_speed_has_limits() -> None:
    with Drone(position=(0.0, -12.0, 2.0), heading=0) as drone:
        drone.command(vx=100)
        drone.step(1.5)
        assert drone.velocity[0] == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize(
    ("command", "low", "high"),
    [
        ((2, 0, 0, 0), (-9, -9, 0.2), (9, -1.1, 3)),  # into the well
        ((0, 0, -1, 0), (-9, -9, 0.2), (9, -1, 1)),  # into the ground
        ((0, 0, 1, 0), (-9, -9, 4), (9, -1, 6)),  # into the sky
        ((-2, 0, 0, 0), (-12, -13, 0), (12, 9, 6)),  # out of the yard
    ],
)
def test_nothing_is_flown_through(
    command: tuple[float, ...], low: tuple[float, ...], high: tuple[float, ...]
) -> None:
    with Drone(position=(0.0, -4.0, 1.2)) as drone:
        drone.command(*command)
        drone.step(12)
        assert (drone.position >= low).all()
        assert (drone.position <= high).all()


def test_house_is_solid() -> None:
    with Drone(position=(-5.5, 0.0, 1.5), heading=np.pi / 2) as drone:
        drone.command(vx=2)
        drone.step(5)
        assert 3 < drone.position[1] < 4.1


def test_drone_hovers_when_commands_stop() -> None:
    with Drone(command_timeout=0.5) as drone, Drone() as steady:
        for each in (drone, steady):
            each.command(vx=1)
            each.step(3)
        assert np.abs(drone.velocity).max() < 0.01
        assert steady.velocity[0] > 0.9
        for _ in range(10):
            drone.command(vx=1)
            drone.step(0.2)
        assert drone.velocity[0] > 0.9


def test_orb_finds_the_well() -> None:
    with Drone(seed=5) as drone:
        drone.command(vx=0.5)
        drone.step(2.5)
        first = drone.frame()
        assert first.truth
        x, y, w, h = cv2.boundingRect(np.array(first.truth["well"]["polygon"], np.int32))
        locator = localize.TemplateLocator(first.image[y : y + h, x : x + w])
        silhouette = np.float32(first.truth["well"]["polygon"]) - np.float32([x, y])
        drone.command(vx=0.3, vy=0.3)
        found = 0
        for _ in range(10):
            drone.step(0.25)
            frame = drone.frame()
            assert frame.truth
            detection = locator.locate(frame.image)
            if detection:
                moved = cv2.perspectiveTransform(silhouette[None], detection.homography)[0]
                found += iou(filled(np.rint(moved)), filled(frame.truth["well"]["polygon"])) > 0.7
        assert found >= 9


def test_orb_finds_it_with_the_recorded_template(recorded: list[Any]) -> None:
    x, y, w, h = images.truth("flight.bag")["template"]["rect"]
    template_frame = recorded[images.truth("flight.bag")["template"]["frame"]]
    locator = localize.TemplateLocator(template_frame.image[y : y + h, x : x + w])
    with Drone(seed=6, position=(-0.6, -5.2, 1.5)) as drone:
        found = 0
        for _ in range(6):
            drone.command(vx=0.3, vy=-0.2)
            drone.step(0.3)
            found += bool(locator.locate(drone.frame().image))
    assert found >= 5


def test_pictures_can_be_taken_from_any_thread() -> None:
    with Drone(seed=1) as drone:
        here = drone.frame()
        with ThreadPoolExecutor(1) as elsewhere:
            there = elsewhere.submit(drone.frame).result()
    assert np.array_equal(here.image, there.image)


def test_bad_input_is_refused() -> None:
    with Drone() as drone:
        with pytest.raises(ValueError, match="finite"):
            drone.command(vx=float("nan"))
        with pytest.raises(ValueError, match="dt"):
            drone.step(-1)
        with pytest.raises(ValueError, match="dt"):
            drone.step(float("nan"))
    with pytest.raises(ValueError, match="closed"):
        drone.frame()


def test_error_names_the_debian_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(backend.ctypes.util, "find_library", lambda _name: None)
    with pytest.raises(RendererError, match=r"apt install .*libegl1"):
        backend.load.__wrapped__()


def test_stored_light_is_that_of_the_world() -> None:
    from course_lib.yard import bake, world  # noqa: PLC0415

    stored = bake.load()
    assert len(stored.facets) == sum(len(part.mesh.faces) for part in world.build())
    # The lawn south of the well lies in the sun, the ground to the north-east of it in its shade.
    row, column = ((11 - 0.9) / 22 * 440, (11 + 1.3) / 22 * 440)
    assert stored.ground[int(row), int(column)] > 80
    assert stored.ground[int((11 + 4) / 22 * 440), 220] < 30


def test_open_camera_reads_the_drone() -> None:
    with camera.open_camera("drone", rate=10) as source:
        frames = [next(source) for _ in range(3)]
    assert [frame.stamp_ns for frame in frames] == [0, 100_000_000, 200_000_000]
    assert all(frame.truth for frame in frames)
    with pytest.raises(TypeError):
        len(source)


def test_open_camera_leaves_your_drone_open() -> None:
    with Drone() as drone:
        with camera.open_camera(drone, rate=20) as source:
            next(source)
            drone.command(vx=1)
            frame = next(source)
        assert frame.stamp_ns == 50_000_000
        drone.step(0.5)
        assert drone.velocity[0] > 0.5
        drone.frame()
