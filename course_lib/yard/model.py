"""Puts the yard, its obstacles and the drone together as one MuJoCo model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from course_lib.yard import bake, scene, world
from course_lib.yard.lens import SIZE, camera_matrix

if TYPE_CHECKING:
    from numpy.typing import NDArray

RADIUS = 0.3  # of the drone, metres: how near its middle comes to anything
TIME_STEP = 0.01  # seconds
CEILING = 6.0  # metres
SEEN, SOLID = 0, 3  # groups of geoms: what is drawn, and what one bumps into

# Boxes (west, south, bottom, east, north, top) and cylinders (x, y, radius, bottom, top), metres.
BOXES = (
    (-8.1, 4.3, 0.0, 1.7, 9.9, 4.8),  # the house, with its bench, flower boxes and roof
    (-1.1, -0.75, 1.6, 1.1, 0.75, 2.3),  # the well's roof
    (5.7, -3.0, 0.0, 6.7, 4.6, 1.3),  # hedges
    (1.8, 5.4, 0.0, 6.0, 6.4, 1.1),
    (-9.7, -4.6, 0.0, -8.7, 4.6, 1.2),
    (2.9, 1.0, 0.0, 3.9, 2.2, 0.8),  # logs
    (-12.0, 9.0, 0.0, 12.0, 9.2, CEILING),  # the edges of the world
    (-12.0, -13.2, 0.0, 12.0, -13.0, CEILING),
    (-12.2, -13.0, 0.0, -12.0, 9.0, CEILING),
    (12.0, -13.0, 0.0, 12.2, 9.0, CEILING),
    (-12.0, -13.0, CEILING, 12.0, 9.0, CEILING + 0.2),
)
CYLINDERS = (
    (0.0, 0.0, 0.95, 0.0, 1.7),  # the well, windlass and all
    (-3.1, 1.5, 0.5, 0.0, 1.9),  # the gardener
    (8.2, 7.5, 2.0, 0.0, CEILING),  # trees
    (9.5, 1.0, 2.0, 0.0, CEILING),
    (-9.8, 5.5, 2.0, 0.0, CEILING),
    (-11.0, -3.0, 2.2, 0.0, CEILING),
)


def build(mujoco: Any) -> Any:  # noqa: ANN401 (MuJoCo has no types)
    """Make the model.

    Parameters
    ----------
    mujoco : module
        Imported by `course_lib.yard.backend`, which chooses how it draws.

    Returns
    -------
    mujoco.MjModel
        Joints x, y, z (metres) and yaw (radians); a camera "front" on a mocap body of its own.
    """
    spec = mujoco.MjSpec()
    spec.option.timestep = TIME_STEP
    spec.option.gravity = [0, 0, 0]  # the flight controller holds the drone up
    visual = spec.visual
    visual.global_.offwidth, visual.global_.offheight = SIZE
    visual.quality.offsamples = 0
    visual.headlight.active = 0
    visual.headlight.ambient = visual.headlight.diffuse = [0, 0, 0]
    spec.worldbody.add_light(ambient=[0, 0, 0], diffuse=[0, 0, 0], specular=[0, 0, 0])
    # In units of the extent: from 5 cm to 150 m.
    spec.stat.extent, spec.stat.center = 10.0, [0, 0, 0]
    visual.map.znear, visual.map.zfar = 0.005, 15.0
    light = bake.load()
    batches, palette = scene.batches(world.build(), light)
    for name, picture in scene.textures(light, palette).items():
        _add_texture(mujoco, spec, name, picture)
    _add_sky(mujoco, spec)
    for batch in [*batches, *scene.shadow_sheets()]:
        _add_batch(mujoco, spec, batch)
    _add_obstacles(mujoco, spec)
    _add_drone(mujoco, spec)
    return spec.compile()


def _add_texture(mujoco: Any, spec: Any, name: str, picture: NDArray[np.uint8]) -> None:  # noqa: ANN401
    height, width, channels = picture.shape
    order = [2, 1, 0, 3][:channels]
    texture = spec.add_texture(
        name=name,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        width=width,
        height=height,
        nchannel=channels,
    )
    texture.data = np.ascontiguousarray(picture[..., order]).tobytes()


def _add_sky(mujoco: Any, spec: Any) -> None:  # noqa: ANN401
    faces = scene.sky_box()
    side, size = faces["side"], len(faces["side"])
    # Right, left, up, down, front, back.
    cube = np.concatenate([side, side, faces["up"], faces["down"], side, side])
    sky = spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        width=size,
        height=6 * size,
        nchannel=3,
    )
    sky.data = np.ascontiguousarray(cube[..., ::-1]).tobytes()


def _add_batch(mujoco: Any, spec: Any, batch: scene.Batch) -> None:  # noqa: ANN401
    material = spec.add_material(name=batch.name, rgba=list(batch.tint))
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = batch.texture
    material.emission, material.specular, material.shininess = 1.0, 0.0, 0.0
    vertices, faces, uv = batch.mesh
    if len(faces) == 1:
        faces = np.repeat(faces, 2, axis=0)  # MuJoCo wants four corners at least
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True) + 1e-12
    mesh = spec.add_mesh(name=batch.name)
    mesh.uservert, mesh.userface = corners.ravel(), np.arange(3 * len(faces))
    # MuJoCo's v runs down the texture.
    mesh.usertexcoord = (np.array([0, 1]) + uv[faces] * [1, -1]).ravel()
    mesh.usernormal = np.repeat(normals, 3, axis=0).ravel()
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL  # sheets have no volume
    spec.worldbody.add_geom(
        name=batch.name,
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=batch.name,
        material=batch.name,
        group=SEEN,
        contype=0,
        conaffinity=0,
    )


def _add_obstacles(mujoco: Any, spec: Any) -> None:  # noqa: ANN401
    add = spec.worldbody.add_geom
    add(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[40, 40, 1], group=SOLID)
    for box in BOXES:
        low, high = np.array(box[:3]), np.array(box[3:])
        middle, half = (low + high) / 2, (high - low) / 2
        add(type=mujoco.mjtGeom.mjGEOM_BOX, pos=middle, size=half, group=SOLID)
    for x, y, radius, bottom, top in CYLINDERS:
        add(
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            pos=[x, y, (bottom + top) / 2],
            size=[radius, (top - bottom) / 2, 0],
            group=SOLID,
        )


def _add_drone(mujoco: Any, spec: Any) -> None:  # noqa: ANN401
    drone = spec.worldbody.add_body(name="drone")
    for name, axis in (("x", [1, 0, 0]), ("y", [0, 1, 0]), ("z", [0, 0, 1])):
        drone.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    drone.add_joint(name="yaw", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    # Smooth: it glides along a wall. One kilogram, so that forces are accelerations.
    drone.add_geom(
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        size=[RADIUS, 0, 0],
        mass=1.0,
        friction=[0, 0, 0],
        condim=1,
        group=SOLID,
    )
    camera = spec.worldbody.add_body(name="camera", mocap=True)
    K = camera_matrix()
    camera.add_camera(
        name="front", fovy=float(np.degrees(2 * np.arctan(SIZE[1] / 2 / K[1, 1]))), resolution=SIZE
    )
