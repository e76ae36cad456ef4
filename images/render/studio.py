"""A photographer's studio in Blender: fresh scene, camera, lights, meshes, render to an array.

Units are metres, z is up. Materials stand in `materials.py`.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import cv2
import numpy as np
from mathutils import Euler, Vector

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Triple = Sequence[float]


def fresh_scene(
    width: int,
    height: int,
    *,
    samples: int = 96,
    seed: int = 0,
    exposure: float = 0.0,
    look: str = "AgX - Medium High Contrast",
    transparent: bool = False,
    bounces: int = 6,
) -> bpy.types.Scene:
    """Start from nothing: an empty scene that Cycles renders on the CPU.

    Parameters
    ----------
    width, height : int
        Of the picture, pixels.
    samples : int
        Paths per pixel; OpenImageDenoise removes what noise they leave.
    seed : int
        Of the path tracer: the same seed gives the same picture.
    exposure : float
        In stops.
    look : str
        Of the AgX view transform.
    transparent : bool
        Leave the world out of the picture and render alpha.
    bounces : int
        Of a light path.

    Returns
    -------
    bpy.types.Scene
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = width, height
    render.resolution_percentage = 100
    render.film_transparent = transparent
    render.threads_mode, render.threads = "FIXED", 2
    cycles.device = "CPU"
    cycles.samples, cycles.seed = samples, seed
    cycles.use_adaptive_sampling = True
    cycles.adaptive_threshold = 0.02
    cycles.use_denoising, cycles.denoiser = True, "OPENIMAGEDENOISE"
    cycles.max_bounces = bounces
    cycles.caustics_reflective = cycles.caustics_refractive = False
    view = scene.view_settings
    view.view_transform, view.look, view.exposure = "AgX", look, exposure
    return scene


def look_at(thing: bpy.types.Object, target: Triple, roll: float = 0.0) -> None:
    """Turn a camera or a light so that it looks at a point.

    Parameters
    ----------
    thing : bpy.types.Object
    target : sequence of 3 floats
        World point.
    roll : float
        Rotation around the viewing axis, radians.
    """
    direction = Vector(target) - thing.location
    turn = direction.to_track_quat("-Z", "Y").to_matrix() @ Euler((0, 0, roll)).to_matrix()
    thing.rotation_euler = turn.to_euler()


def add_camera(
    scene: bpy.types.Scene,
    location: Triple,
    target: Triple,
    *,
    lens: float = 50.0,
    roll: float = 0.0,
    f_stop: float | None = None,
    focus: Triple | None = None,
) -> bpy.types.Object:
    """Place the scene's camera.

    Parameters
    ----------
    scene : bpy.types.Scene
    location, target : sequence of 3 floats
        Where it is and where it looks.
    lens : float
        Focal length in millimetres on a sensor 36 mm wide.
    roll : float
        Around the viewing axis, radians.
    f_stop : float, optional
        Aperture of the depth of field; none without it.
    focus : sequence of 3 floats, optional
        World point that is sharp; the target without it.

    Returns
    -------
    bpy.types.Object
    """
    data = bpy.data.cameras.new("camera")
    data.lens, data.sensor_width, data.clip_start = lens, 36.0, 0.01
    camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(camera)
    camera.location = location
    look_at(camera, target, roll)
    if f_stop is not None:
        data.dof.use_dof = True
        data.dof.aperture_fstop = f_stop
        sharp = Vector(focus if focus is not None else target)
        forward = (Vector(target) - Vector(location)).normalized()
        data.dof.focus_distance = (sharp - Vector(location)).dot(forward)
    scene.camera = camera
    return camera


def add_area_light(
    scene: bpy.types.Scene,
    location: Triple,
    target: Triple,
    *,
    size: float = 1.0,
    power: float = 50.0,
    colour: Triple = (1.0, 1.0, 1.0),
) -> bpy.types.Object:
    """Add a square soft box.

    Parameters
    ----------
    scene : bpy.types.Scene
    location, target : sequence of 3 floats
    size : float
        Side, metres: larger is softer.
    power : float
        Watts.
    colour : sequence of 3 floats
        Linear RGB.

    Returns
    -------
    bpy.types.Object
    """
    data = bpy.data.lights.new("light", "AREA")
    data.size, data.energy, data.color = size, power, colour
    light = bpy.data.objects.new("light", data)
    scene.collection.objects.link(light)
    light.location = location
    look_at(light, target)
    return light


def set_world(scene: bpy.types.Scene, colour: Triple, strength: float = 1.0) -> None:
    """Light everything evenly from all around.

    Parameters
    ----------
    scene : bpy.types.Scene
    colour : sequence of 3 floats
        Linear RGB.
    strength : float
    """
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*colour, 1.0)
    background.inputs["Strength"].default_value = strength
    scene.world = world


def add_mesh(
    scene: bpy.types.Scene,
    name: str,
    vertices: ArrayLike,
    faces: Sequence[Sequence[int]],
    material: bpy.types.Material,
    *,
    uvs: ArrayLike | None = None,
    smooth: bool = True,
    location: Triple = (0, 0, 0),
    rotation: Triple = (0, 0, 0),
) -> bpy.types.Object:
    """Add a mesh built with numpy.

    Parameters
    ----------
    scene : bpy.types.Scene
    name : str
    vertices : array_like, shape (N, 3)
    faces : sequence of sequences of int
        Counter-clockwise seen from outside.
    material : bpy.types.Material
    uvs : array_like, shape (N, 2), optional
        Texture coordinates per vertex, v up.
    smooth : bool
        Shade smoothly.
    location, rotation : sequence of 3 floats
        Metres and XYZ Euler angles in radians.

    Returns
    -------
    bpy.types.Object
    """
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(vertices, dtype=float).tolist(), [], [list(f) for f in faces])
    if uvs is not None:
        layer = mesh.uv_layers.new()
        corners = np.empty(len(mesh.loops), dtype=np.int32)
        mesh.loops.foreach_get("vertex_index", corners)
        layer.data.foreach_set("uv", np.asarray(uvs, dtype=np.float32)[corners].ravel())
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    mesh.materials.append(material)
    mesh.update()
    thing = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(thing)
    thing.location, thing.rotation_euler = location, rotation
    return thing


def add_box(
    scene: bpy.types.Scene,
    name: str,
    size: Triple,
    material: bpy.types.Material,
    *,
    location: Triple = (0, 0, 0),
    rotation: Triple = (0, 0, 0),
    bevel: float = 0.0,
) -> bpy.types.Object:
    """Add a cuboid centred on its location.

    Parameters
    ----------
    scene : bpy.types.Scene
    name : str
    size : sequence of 3 floats
        Metres along x, y, z.
    material : bpy.types.Material
    location, rotation : sequence of 3 floats
        Metres and XYZ Euler angles in radians.
    bevel : float
        Rounding of the edges, metres.

    Returns
    -------
    bpy.types.Object
    """
    half = np.asarray(size) / 2
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    box = add_mesh(
        scene,
        name,
        signs * half,
        faces,
        material,
        smooth=False,
        location=location,
        rotation=rotation,
    )
    if bevel > 0:
        modifier = box.modifiers.new("bevel", "BEVEL")
        modifier.width, modifier.segments = bevel, 3
    return box


def to_world(thing: bpy.types.Object, points: ArrayLike) -> NDArray[np.float64]:
    """Take points of an object's own frame to the world.

    Parameters
    ----------
    thing : bpy.types.Object
    points : array_like, shape (N, 3)

    Returns
    -------
    ndarray, shape (N, 3), float64
    """
    bpy.context.view_layer.update()
    matrix = np.array(thing.matrix_world, dtype=np.float64)
    return np.asarray(points, dtype=np.float64).reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]


def render(scene: bpy.types.Scene) -> NDArray[np.uint8]:
    """Render the scene's current frame.

    Parameters
    ----------
    scene : bpy.types.Scene

    Returns
    -------
    ndarray, shape (H, W, 3) or (H, W, 4), uint8
        BGR, or BGRA when the scene's film is transparent.

    Raises
    ------
    OSError
        If Blender wrote no picture.
    """
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "PNG", "8"
    settings.color_mode = "RGBA" if scene.render.film_transparent else "RGB"
    # Dithering is random noise of its own; the sensor model adds what we want.
    scene.render.dither_intensity = 0.0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "frame.png"
        scene.render.filepath = str(path)
        bpy.ops.render.render(write_still=True)
        image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise OSError(f"Blender rendered nothing for scene {scene.name!r}")
    return np.asarray(image, dtype=np.uint8)


def mask(scene: bpy.types.Scene, thing: bpy.types.Object) -> NDArray[np.float32]:
    """Render how much of each pixel an object covers, with everything that hides it.

    Parameters
    ----------
    scene : bpy.types.Scene
    thing : bpy.types.Object

    Returns
    -------
    ndarray, shape (H, W), float32
        0 to 1. Without depth of field.
    """

    def emission(name: str, value: float) -> bpy.types.Material:
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        nodes, links = material.node_tree.nodes, material.node_tree.links
        nodes.clear()
        light, out = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
        light.inputs["Color"].default_value = (value, value, value, 1)
        links.new(light.outputs[0], out.inputs["Surface"])
        return material

    black, white = emission("mask black", 0.0), emission("mask white", 1.0)
    view, camera, cycles = scene.view_settings, scene.camera.data, scene.cycles
    kept_materials = {
        o: [slot.material for slot in o.material_slots] for o in scene.objects if o.type == "MESH"
    }
    kept = (view.view_transform, view.look, view.exposure, camera.dof.use_dof, scene.world)
    kept_cycles = (cycles.samples, cycles.use_denoising)
    hidden = [o for o in scene.objects if o.type == "LIGHT" and not o.hide_render]
    for o in kept_materials:
        for slot in o.material_slots:
            slot.material = white if o == thing else black
    for o in hidden:
        o.hide_render = True
    # "Raw" turns coverage 0..1 to 0..255 without a tone curve.
    view.look, view.view_transform, view.exposure = "None", "Raw", 0.0
    camera.dof.use_dof, scene.world = False, None
    cycles.samples, cycles.use_denoising = 32, False
    try:
        picture = render(scene)
    finally:
        view.view_transform, view.look, view.exposure = kept[0], kept[1], kept[2]
        camera.dof.use_dof, scene.world = kept[3], kept[4]
        cycles.samples, cycles.use_denoising = kept_cycles
        for o, materials in kept_materials.items():
            for slot, material in zip(o.material_slots, materials, strict=True):
                slot.material = material
        for o in hidden:
            o.hide_render = False
    return picture[..., 0].astype(np.float32) / 255
