"""Exact ground truth for a rendered picture, read from Blender's own camera.

Blender measures picture coordinates from the picture's edges and looks along -z with y up.
OpenCV puts pixel centres at integers and looks along +z with y down. Every function here
speaks OpenCV.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import bpy
    from numpy.typing import ArrayLike, NDArray

OPENCV_FROM_BLENDER = np.diag([1.0, -1.0, -1.0, 1.0])


def intrinsics(scene: bpy.types.Scene) -> NDArray[np.float64]:
    """Return the camera matrix K of the scene's camera, in pixels.

    Parameters
    ----------
    scene : bpy.types.Scene
        Its camera must be a perspective camera with square pixels.

    Returns
    -------
    ndarray, shape (3, 3), float64

    Raises
    ------
    ValueError
        If the camera is not a perspective camera with the automatic sensor fit.
    """
    camera = scene.camera.data
    if camera.type != "PERSP" or camera.sensor_fit != "AUTO":
        raise ValueError(f"camera {camera.name!r}: need type PERSP and sensor_fit AUTO")
    width, height = scene.render.resolution_x, scene.render.resolution_y
    longer = max(width, height)
    focal = camera.lens / camera.sensor_width * longer
    # Half a pixel less: Blender's 0 is the first pixel's edge, OpenCV's is its centre.
    cx = width / 2 - camera.shift_x * longer - 0.5
    cy = height / 2 + camera.shift_y * longer - 0.5
    return np.array([[focal, 0, cx], [0, focal, cy], [0, 0, 1]])


def camera_from_world(scene: bpy.types.Scene) -> NDArray[np.float64]:
    """Return T_camera_from_world of the scene's camera, in OpenCV's camera axes.

    Parameters
    ----------
    scene : bpy.types.Scene
        The current frame counts, also for an animated camera.

    Returns
    -------
    ndarray, shape (4, 4), float64
        Takes homogeneous world points to x right, y down, z forward.
    """
    scene.view_layers[0].update()
    world_from_camera = np.array(scene.camera.matrix_world, dtype=np.float64)
    return OPENCV_FROM_BLENDER @ np.linalg.inv(world_from_camera)


def in_camera(scene: bpy.types.Scene, points: ArrayLike) -> NDArray[np.float64]:
    """Take world points to OpenCV camera coordinates; z is the depth.

    Parameters
    ----------
    scene : bpy.types.Scene
    points : array_like, shape (N, 3)

    Returns
    -------
    ndarray, shape (N, 3), float64
    """
    T = camera_from_world(scene)
    return np.asarray(points, dtype=np.float64).reshape(-1, 3) @ T[:3, :3].T + T[:3, 3]


def project(scene: bpy.types.Scene, points: ArrayLike) -> NDArray[np.float64]:
    """Project world points into the picture.

    Parameters
    ----------
    scene : bpy.types.Scene
    points : array_like, shape (N, 3)

    Returns
    -------
    ndarray, shape (N, 2), float64
        (x, y), pixel centres at integers.

    Raises
    ------
    ValueError
        If a point lies on or behind the camera's plane.
    """
    local = in_camera(scene, points)
    if (local[:, 2] <= 0).any():
        raise ValueError("points: at least one is behind the camera; clip before projecting")
    pixels = local @ intrinsics(scene).T
    return pixels[:, :2] / pixels[:, 2:]


def template_corners(size: tuple[int, int]) -> NDArray[np.float64]:
    """Return a template's corner pixels in the order TL, BL, BR, TR.

    Parameters
    ----------
    size : tuple of int
        (width, height) of the template in pixels.

    Returns
    -------
    ndarray, shape (4, 2), float64
    """
    w, h = size
    return np.array([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]], dtype=np.float64)


def homography(size: tuple[int, int], edges: ArrayLike) -> NDArray[np.float64]:
    """Return H_scene_from_template of a flat printed object.

    Parameters
    ----------
    size : tuple of int
        (width, height) of the template in pixels.
    edges : array_like, shape (4, 2)
        Where the physical corners of the object appear in the scene: TL, BL, BR, TR.

    Returns
    -------
    ndarray, shape (3, 3), float64
    """
    w, h = size
    # The object ends where its outermost pixels end, half a pixel outside their centres.
    ends = template_corners((w + 1, h + 1)) - 0.5
    return np.asarray(
        cv2.getPerspectiveTransform(
            ends.astype(np.float32), np.asarray(edges, dtype=np.float32).reshape(4, 2)
        ),
        dtype=np.float64,
    )


def warp_points(H: ArrayLike, points: ArrayLike) -> NDArray[np.float64]:
    """Apply a homography to points.

    Parameters
    ----------
    H : array_like, shape (3, 3)
    points : array_like, shape (N, 2)

    Returns
    -------
    ndarray, shape (N, 2), float64
    """
    xy = np.asarray(points, dtype=np.float64).reshape(-1, 1, 2)
    return cv2.perspectiveTransform(xy, np.asarray(H, dtype=np.float64)).reshape(-1, 2)


def camera_record(scene: bpy.types.Scene) -> dict[str, Any]:
    """Return the record's `camera` entry: K and T_camera_from_world.

    Parameters
    ----------
    scene : bpy.types.Scene

    Returns
    -------
    dict
    """
    return {"K": intrinsics(scene), "T_camera_from_world": camera_from_world(scene)}


def _plain(value: Any) -> Any:  # noqa: ANN401 - JSON-like data of any shape
    """Turn arrays to lists and round, so that the same scene gives the same bytes."""
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float | np.floating):
        # Nine significant digits: a homography's last row is of the order of 1e-5.
        return float(f"{float(value):.9g}") + 0.0
    if isinstance(value, np.integer):
        return int(value)
    return value


def write(path: Path, record: Mapping[str, Any]) -> None:
    """Write a truth record, rounded, so that a second rendering gives the same file.

    Parameters
    ----------
    path : Path
        images/truth/<stem>.json; the folder is made.
    record : mapping
        May hold ndarrays.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(_plain(dict(record)), indent=1) + "\n", encoding="utf-8")


def read(path: Path) -> dict[str, Any]:
    """Read a truth record that another scene has written.

    Parameters
    ----------
    path : Path

    Returns
    -------
    dict

    Raises
    ------
    FileNotFoundError
        The other scene was not rendered yet.
    """
    if not path.exists():
        raise FileNotFoundError(f"{path} is missing: render {path.stem} first")
    record: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return record
