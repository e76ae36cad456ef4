"""Render the drone's flights and record them as ROS 1 bags with the truth of every frame.

Frames are kept in build/ as they come, so an interrupted run goes on where it was.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import bpy
import cv2
import flight_path
import numpy as np
import sensor
import truth
import yard
from mathutils import Matrix
from numpy.typing import NDArray
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from course_lib.yard import world as yard_world
from course_lib.yard.lens import SIZE, camera_matrix
from course_lib.yard.silhouette import silhouette

CACHE = Path(__file__).resolve().parents[2] / "build" / "flights"
TOPIC = "/camera/rgb"
FRAME_ID = "camera_rgb_optical_frame"
START_NS = 1_760_000_000_000_000_000
STEP_NS = 1_000_000_000 // flight_path.FRAMES_PER_SECOND
SAMPLES = 10
QUALITY = 82
STORE = get_typestore(Stores.ROS1_NOETIC)


def _animate(scene: bpy.types.Scene, poses: NDArray[np.float64]) -> None:
    scene.camera.rotation_mode = "QUATERNION"
    previous = None
    for index, T in enumerate(poses):
        world = Matrix((np.linalg.inv(truth.OPENCV_FROM_BLENDER @ T)).tolist())
        turn = world.to_quaternion()
        if previous is not None:
            turn.make_compatible(previous)
        previous = turn
        scene.camera.location, scene.camera.rotation_quaternion = world.translation, turn
        scene.camera.keyframe_insert("location", frame=index)
        scene.camera.keyframe_insert("rotation_quaternion", frame=index)
    # 25 ms of exposure around the frame's stamp: a quick turn smears, as on a real drone.
    scene.render.fps = flight_path.FRAMES_PER_SECOND
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.25


def check_camera(scene: bpy.types.Scene, pose: NDArray[np.float64]) -> None:
    """Hold the truth against the renderer's own camera, which computes in single precision.

    Parameters
    ----------
    scene : bpy.types.Scene
        At the frame in question.
    pose : ndarray, shape (4, 4)
        The T_camera_from_world that the truth states.

    Raises
    ------
    ValueError
        If the pose or the camera matrix differs.
    """
    if not np.allclose(truth.camera_from_world(scene), pose, atol=1e-4):
        raise ValueError(f"pose: frame {scene.frame_current} is not where Blender's camera stands")
    if not np.allclose(truth.intrinsics(scene), camera_matrix(), atol=1e-3):
        raise ValueError("camera matrix: differs from Blender's camera; compare HFOV and SIZE")


def render_frames(flight: flight_path.Flight, wanted: range) -> list[Path]:
    """Render the frames that are not there yet; return the paths of all wanted ones."""
    folder = CACHE / flight.name
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{index:04}.png" for index in wanted]
    missing = [(i, p) for i, p in zip(wanted, paths, strict=True) if not p.exists()]
    if not missing:
        return paths
    scene = yard.build(SAMPLES)
    _animate(scene, flight_path.poses(flight))
    begun = time.monotonic()
    for done, (index, path) in enumerate(missing, 1):
        scene.frame_set(index)
        check_camera(scene, flight_path.poses(flight)[index])
        part = path.with_name(f"part_{path.name}")
        yard.render(scene, part)
        part.replace(path)
        left = (time.monotonic() - begun) / done * (len(missing) - done)
        print(f"{flight.name} {index:4}  {left / 60:5.1f} min left", file=sys.stderr, flush=True)
    return paths


def see(path: Path, index: int, seed: int) -> NDArray[np.uint8]:
    """Return a rendered frame as the drone's camera sees it, BGR uint8."""
    # Automatic exposure hunts a little while the drone turns from sun to shade.
    light = 1.0 + 0.06 * np.sin(index / 17) + 0.03 * np.sin(index / 5.3)
    picture = cv2.imread(str(path), cv2.IMREAD_COLOR)
    return sensor.expose(
        picture, seed=seed + index, light=light, blur=0.6, electrons=5000, read_noise=8
    )


def _header(index: int, stamp_ns: int) -> Any:  # noqa: ANN401 - rosbags makes the class
    stamp = STORE.types["builtin_interfaces/msg/Time"](
        sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9
    )
    return STORE.types["std_msgs/msg/Header"](seq=index, stamp=stamp, frame_id=FRAME_ID)


def write_bag(path: Path, pictures: list[NDArray[np.uint8]]) -> list[int]:
    """Write compressed pictures and camera information; return the stamps, ns."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    K = camera_matrix()
    image_type, info_type = "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/CameraInfo"
    region = STORE.types["sensor_msgs/msg/RegionOfInterest"](
        x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
    )
    stamps = [START_NS + index * STEP_NS for index in range(len(pictures))]
    with Writer(path) as bag:
        images = bag.add_connection(f"{TOPIC}/image_raw/compressed", image_type, typestore=STORE)
        infos = bag.add_connection(f"{TOPIC}/camera_info", info_type, typestore=STORE)
        for index, (stamp, picture) in enumerate(zip(stamps, pictures, strict=True)):
            _, jpeg = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
            image = STORE.types[image_type](
                header=_header(index, stamp), format="bgr8; jpeg compressed bgr8", data=jpeg.ravel()
            )
            info = STORE.types[info_type](
                header=_header(index, stamp),
                height=SIZE[1],
                width=SIZE[0],
                distortion_model="plumb_bob",
                D=np.zeros(5),
                K=K.ravel(),
                R=np.eye(3).ravel(),
                P=np.hstack([K, np.zeros((3, 1))]).ravel(),
                binning_x=0,
                binning_y=0,
                roi=region,
            )
            bag.write(images, stamp, STORE.serialize_ros1(image, image_type))
            bag.write(infos, stamp, STORE.serialize_ros1(info, info_type))
    return stamps


def record(flight: flight_path.Flight, out: Path, wanted: range) -> Path:
    """Render a flight, write its bag and its truth.

    Parameters
    ----------
    flight : Flight
    out : Path
        Folder of the pictures.
    wanted : range
        Frames to record.

    Returns
    -------
    Path
        The bag.
    """
    paths = render_frames(flight, wanted)
    seed = sum(flight.name.encode())
    pictures = [see(path, index, seed) for index, path in zip(wanted, paths, strict=True)]
    bag = out / f"{flight.name}.bag"
    stamps = write_bag(bag, pictures)
    K = camera_matrix()
    poses = flight_path.poses(flight)
    well = yard_world.triangles(list(yard_world.well()))
    frames = []
    for stamp, index in zip(stamps, wanted, strict=True):
        polygon, visible = silhouette(well, K, poses[index], SIZE)
        frames.append(
            {
                "stamp_ns": stamp,
                "T_camera_from_world": poses[index],
                "well": {"polygon": polygon.astype(int).tolist(), "visible": round(visible, 4)},
            }
        )
    about: dict[str, Any] = {
        "bag": bag.name,
        "size": list(SIZE),
        "camera": {"K": K},
        "wall_y": yard_world.WALL_Y,
        "frames": frames,
    }
    if flight.template and flight.template[0] in wanted:
        index, rect = flight.template
        about["template"] = {"frame": wanted.index(index), "rect": list(rect)}
    truth.write(bag.parent / "truth" / f"{bag.stem}.json", about)
    return bag


def main(out: Path, *, preview: bool = False) -> list[Path]:
    """Record every flight.

    Parameters
    ----------
    out : Path
        Folder of the pictures.
    preview : bool
        Take every tenth frame only.

    Returns
    -------
    list of Path
        The bags.
    """
    flights = (flight_path.MAIN, *flight_path.HELD_OUT)
    return [
        record(flight, out, range(0, flight.length, 10 if preview else 1)) for flight in flights
    ]
