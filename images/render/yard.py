"""Build the yard in Blender from `course_lib.yard.world`, and photograph it from a pose."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from course_lib.yard import world as yard_world
from course_lib.yard.lens import HFOV, SIZE
from course_lib.yard.part import Part


def _linear(colour: tuple[int, int, int]) -> tuple[float, float, float, float]:
    """BGR 0–255 as Blender's linear RGBA."""
    c = np.array(colour[::-1]) / 255
    r, g, b = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    return float(r), float(g), float(b), 1.0


def _material(part: Part, pictures: dict[str, bpy.types.Image]) -> bpy.types.Material:
    key = part.texture or "flat {} {} {}".format(*part.colour)
    if key in bpy.data.materials:
        return bpy.data.materials[key]
    material = bpy.data.materials.new(key)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    shader = nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = _linear(part.colour)
    if part.texture:
        texture = nodes.new("ShaderNodeTexImage")
        texture.image = pictures[part.texture]
        links.new(texture.outputs["Color"], shader.inputs["Color"])
    output = nodes.new("ShaderNodeOutputMaterial")
    links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    return material


def _picture(name: str, pixels: NDArray[np.uint8]) -> bpy.types.Image:
    h, w = pixels.shape[:2]
    image = bpy.data.images.new(name, w, h)
    rgba = np.ones((h, w, 4), np.float32)
    rgba[..., :3] = pixels[::-1, :, ::-1] / 255  # Blender's row 0 is at the bottom, RGB
    image.pixels.foreach_set(rgba.ravel())
    image.pack()
    return image


def _object(part: Part, pictures: dict[str, bpy.types.Image]) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(part.name)
    mesh.from_pydata(part.mesh.vertices.tolist(), [], part.mesh.faces.tolist())
    layer = mesh.uv_layers.new(name="uv")
    layer.data.foreach_set("uv", part.mesh.uv[part.mesh.faces.ravel()].ravel())
    mesh.materials.append(_material(part, pictures))
    thing = bpy.data.objects.new(part.name, mesh)
    thing.location = part.position
    bpy.context.collection.objects.link(thing)
    return thing


def _sky(scene: bpy.types.Scene) -> None:
    world = bpy.data.worlds.new("sky")
    scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()
    place = nodes.new("ShaderNodeTexCoord")
    split = nodes.new("ShaderNodeSeparateXYZ")
    ramp = nodes.new("ShaderNodeValToRGB")
    back = nodes.new("ShaderNodeBackground")
    out = nodes.new("ShaderNodeOutputWorld")
    ramp.color_ramp.elements[0].color = _linear(yard_world.SKY_HORIZON)
    ramp.color_ramp.elements[1].color = _linear(yard_world.SKY_ZENITH)
    ramp.color_ramp.elements[1].position = 0.6
    links.new(place.outputs["Generated"], split.inputs["Vector"])
    links.new(split.outputs["Z"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], back.inputs["Color"])
    links.new(back.outputs["Background"], out.inputs["Surface"])


def _sun() -> None:
    light = bpy.data.lights.new("sun", "SUN")
    light.energy = 3.2
    light.angle = np.radians(1.5)
    light.color = (1.0, 0.95, 0.86)
    sun = bpy.data.objects.new("sun", light)
    direction = np.array(yard_world.SUN_DIRECTION)
    x, y, z = direction / np.linalg.norm(direction)
    sun.rotation_euler = (float(np.arccos(z)), 0.0, float(np.arctan2(y, x) + np.pi / 2))
    bpy.context.collection.objects.link(sun)


def build(samples: int = 16) -> bpy.types.Scene:
    """Empty Blender, build the yard with its light and a camera; the scene is ready to render.

    Parameters
    ----------
    samples : int
        Paths per pixel; the denoiser cleans what remains.
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    pictures = {name: _picture(name, p) for name, p in yard_world.textures().items()}
    for part in yard_world.build():
        _object(part, pictures)
    _sky(scene)
    _sun()
    lens = bpy.data.cameras.new("front")
    lens.angle = HFOV
    lens.clip_end = 300
    scene.camera = bpy.data.objects.new("front", lens)
    bpy.context.collection.objects.link(scene.camera)
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.render.threads_mode = "FIXED"
    scene.render.threads = 2
    scene.render.use_persistent_data = True
    scene.view_settings.view_transform = "Standard"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = False
    cycles.seed = 0
    cycles.max_bounces = 2
    cycles.diffuse_bounces = 2
    cycles.use_denoising = True
    cycles.denoiser = "OPENIMAGEDENOISE"
    cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
    cycles.denoising_prefilter = "FAST"
    return scene


def render(scene: bpy.types.Scene, path: Path) -> None:
    """Render the scene's current frame into a PNG file."""
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
