"""Procedural materials: plain, picture, wood, paper, cloth, ceramic.

Colours are linear RGB, as Blender wants them; `rgb` converts from the usual sRGB.
Textures use object coordinates, so their scales are features per metre.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    Triple = Sequence[float]


def rgb(code: str) -> tuple[float, float, float]:
    """Convert a colour such as "#c81e1e" from sRGB to linear.

    Parameters
    ----------
    code : str
        A hash sign and six hexadecimal digits.

    Returns
    -------
    tuple of 3 floats
    """
    parts = [int(code[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    r, g, b = (p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return r, g, b


WALNUT, OAK, PLUM = rgb("#4a2a14"), rgb("#a8703c"), rgb("#5b2a6e")


class Shader:
    """A material's node tree around one Principled surface.

    Attributes
    ----------
    material : bpy.types.Material
    surface : bpy.types.Node
        The Principled BSDF.
    """

    def __init__(self, name: str) -> None:
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.surface = self.tree.nodes["Principled BSDF"]

    def node(self, kind: str, **settings: Any) -> bpy.types.Node:  # noqa: ANN401 - node properties
        """Add a node such as "ShaderNodeTexNoise", with its properties.

        Parameters
        ----------
        kind : str
        **settings
            Attributes of the node.

        Returns
        -------
        bpy.types.Node
        """
        node = self.tree.nodes.new(kind)
        for key, value in settings.items():
            setattr(node, key, value)
        return node

    def link(self, output: bpy.types.NodeSocket, target: bpy.types.NodeSocket) -> None:
        """Connect an output with an input.

        Parameters
        ----------
        output, target : bpy.types.NodeSocket
        """
        self.tree.links.new(output, target)

    def set(self, **values: Any) -> None:  # noqa: ANN401 - floats, tuples or sockets
        """Set inputs of the surface: `base_color=...`, `roughness=...`, `coat_weight=...`.

        Parameters
        ----------
        **values
            A number, a tuple, or another node's output; underscores stand for spaces.
        """
        for key, value in values.items():
            name = " ".join(w if w == "IOR" else w.capitalize() for w in key.split("_"))
            socket = self.surface.inputs["IOR" if key == "ior" else name]
            if isinstance(value, bpy.types.NodeSocket):
                self.link(value, socket)
            elif isinstance(value, tuple) and len(value) == 3 and len(socket.default_value) == 4:
                socket.default_value = (*value, 1.0)
            else:
                socket.default_value = value

    def coordinates(
        self, scale: Triple = (1, 1, 1), *, rotation: Triple = (0, 0, 0), kind: str = "Object"
    ) -> bpy.types.NodeSocket:
        """Return texture coordinates, scaled and turned.

        Parameters
        ----------
        scale, rotation : sequence of 3 floats
        kind : str
            "Object", "UV" or "Generated".

        Returns
        -------
        bpy.types.NodeSocket
        """
        source = self.node("ShaderNodeTexCoord")
        mapping = self.node("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = scale
        mapping.inputs["Rotation"].default_value = rotation
        self.link(source.outputs[kind], mapping.inputs["Vector"])
        return mapping.outputs["Vector"]

    def noise(
        self,
        vector: bpy.types.NodeSocket,
        scale: float,
        *,
        detail: float = 4.0,
        roughness: float = 0.55,
        distortion: float = 0.0,
    ) -> bpy.types.NodeSocket:
        """Return smooth noise between 0 and 1.

        Parameters
        ----------
        vector : bpy.types.NodeSocket
        scale : float
            Features per unit of the coordinates.
        detail, roughness, distortion : float

        Returns
        -------
        bpy.types.NodeSocket
        """
        noise = self.node("ShaderNodeTexNoise")
        self.link(vector, noise.inputs["Vector"])
        noise.inputs["Scale"].default_value = scale
        noise.inputs["Detail"].default_value = detail
        noise.inputs["Roughness"].default_value = roughness
        noise.inputs["Distortion"].default_value = distortion
        return noise.outputs["Fac"]

    def ramp(
        self, factor: bpy.types.NodeSocket, stops: Sequence[tuple[float, Triple]]
    ) -> bpy.types.NodeSocket:
        """Map a factor to colours.

        Parameters
        ----------
        factor : bpy.types.NodeSocket
        stops : sequence of (position, colour)
            Two or more, in order.

        Returns
        -------
        bpy.types.NodeSocket
        """
        node = self.node("ShaderNodeValToRGB")
        elements = node.color_ramp.elements
        while len(elements) < len(stops):
            elements.new(0.5)
        for element, (position, colour) in zip(elements, stops, strict=True):
            element.position, element.color = position, (*colour, 1.0)
        self.link(factor, node.inputs["Fac"])
        return node.outputs["Color"]

    def bump(
        self,
        height: bpy.types.NodeSocket,
        *,
        strength: float = 0.3,
        distance: float = 0.001,
        over: bpy.types.NodeSocket | None = None,
    ) -> bpy.types.NodeSocket:
        """Turn a height into a normal and give it to the surface.

        Parameters
        ----------
        height : bpy.types.NodeSocket
        strength : float
        distance : float
            Metres of height for a factor of 1.
        over : bpy.types.NodeSocket, optional
            A coarser bump's normal that this one is added to.

        Returns
        -------
        bpy.types.NodeSocket
        """
        node = self.node("ShaderNodeBump")
        node.inputs["Strength"].default_value = strength
        node.inputs["Distance"].default_value = distance
        self.link(height, node.inputs["Height"])
        if over is not None:
            self.link(over, node.inputs["Normal"])
        self.link(node.outputs["Normal"], self.surface.inputs["Normal"])
        return node.outputs["Normal"]


def plain(
    name: str,
    colour: Triple,
    *,
    roughness: float = 0.5,
    metallic: float = 0.0,
    coat: float = 0.0,
    emission: float = 0.0,
) -> bpy.types.Material:
    """Return one colour: plastic, lacquer (`coat`), metal, or a lamp (`emission`).

    Parameters
    ----------
    name : str
    colour : sequence of 3 floats
    roughness, metallic, coat : float
        0 to 1.
    emission : float
        Light given off.

    Returns
    -------
    bpy.types.Material
    """
    shader = Shader(name)
    shader.set(base_color=tuple(colour), roughness=roughness, metallic=metallic, coat_weight=coat)
    if emission:
        shader.set(emission_color=tuple(colour), emission_strength=emission)
    return shader.material


def picture(
    name: str, path: Path, *, roughness: float = 0.4, coat: float = 0.0
) -> bpy.types.Material:
    """Return a printed surface: the picture file lies on the mesh's UV coordinates.

    Parameters
    ----------
    name : str
    path : Path
        sRGB picture; its alpha is ignored.
    roughness, coat : float
        0 to 1; a glossy cover has a coat.

    Returns
    -------
    bpy.types.Material
    """
    shader = Shader(name)
    texture = shader.node("ShaderNodeTexImage", extension="EXTEND", interpolation="Cubic")
    texture.image = bpy.data.images.load(str(path))
    shader.link(shader.coordinates(kind="UV"), texture.inputs["Vector"])
    shader.set(
        base_color=texture.outputs["Color"],
        roughness=roughness,
        coat_weight=coat,
        coat_roughness=0.12,
    )
    return shader.material


def wood(
    name: str = "wood",
    *,
    dark: Triple = WALNUT,
    light: Triple = OAK,
    rings: float = 9.0,
    roughness: float = 0.4,
    coat: float = 0.15,
) -> bpy.types.Material:
    """Return wood with grain along the object's x axis.

    Parameters
    ----------
    name : str
    dark, light : sequence of 3 floats
        Late and early wood.
    rings : float
        Bands per metre across the grain.
    roughness, coat : float
        0 to 1.

    Returns
    -------
    bpy.types.Material
    """
    shader = Shader(name)
    along = shader.coordinates((0.35, 4.0, 4.0))
    wave = shader.node("ShaderNodeTexWave", wave_type="BANDS", bands_direction="Y")
    shader.link(along, wave.inputs["Vector"])
    wave.inputs["Scale"].default_value = rings / 4
    wave.inputs["Distortion"].default_value = 9.0
    wave.inputs["Detail"].default_value = 4.0
    wave.inputs["Detail Scale"].default_value = 1.6
    fibres = shader.noise(shader.coordinates((12, 420, 420)), 1.0, detail=3)
    mix = shader.node("ShaderNodeMath", operation="MULTIPLY_ADD")
    shader.link(fibres, mix.inputs[0])
    mix.inputs[1].default_value = 0.55
    halved = shader.node("ShaderNodeMath", operation="MULTIPLY")
    shader.link(wave.outputs["Fac"], halved.inputs[0])
    halved.inputs[1].default_value = 0.5
    shader.link(halved.outputs[0], mix.inputs[2])
    grain = mix.outputs[0]
    middle = tuple((2 * a + 3 * b) / 5 for a, b in zip(dark, light, strict=True))
    shader.set(
        base_color=shader.ramp(grain, [(0.15, dark), (0.5, middle), (0.85, light)]),
        roughness=roughness,
        coat_weight=coat,
        coat_roughness=0.25,
    )
    shader.bump(grain, strength=0.25, distance=0.0006)
    return shader.material


def paper(
    name: str = "paper", colour: Triple = (0.8, 0.78, 0.72), *, fibres: float = 900.0
) -> bpy.types.Material:
    """Return uncoated paper or card with a faint fibre texture.

    Parameters
    ----------
    name : str
    colour : sequence of 3 floats
    fibres : float
        Per metre.

    Returns
    -------
    bpy.types.Material
    """
    shader = Shader(name)
    noise = shader.noise(shader.coordinates(), fibres)
    darker = tuple(c * 0.86 for c in colour)
    shader.set(base_color=shader.ramp(noise, [(0.3, darker), (0.7, colour)]), roughness=0.85)
    shader.bump(noise, strength=0.15, distance=0.0003)
    return shader.material


def cloth(
    name: str = "cloth",
    colour: Triple = PLUM,
    *,
    threads: float = 700.0,
    contrast: float = 0.55,
) -> bpy.types.Material:
    """Return plain-woven cloth in the object's x, y plane.

    Parameters
    ----------
    name : str
    colour : sequence of 3 floats
    threads : float
        Per metre.
    contrast : float
        How dark the gaps between threads are, 0 to 1.

    Returns
    -------
    bpy.types.Material
    """
    shader = Shader(name)
    at = shader.coordinates()
    waves = []
    for direction in "XY":
        wave = shader.node("ShaderNodeTexWave", wave_type="BANDS", bands_direction=direction)
        shader.link(at, wave.inputs["Vector"])
        # Blender's bands repeat every pi/10 units at scale 1.
        wave.inputs["Scale"].default_value = threads * 0.314159
        wave.inputs["Distortion"].default_value = 1.2
        wave.inputs["Detail Scale"].default_value = 0.15
        waves.append(wave.outputs["Fac"])
    weave = shader.node("ShaderNodeMath", operation="MULTIPLY")
    for wave, socket in zip(waves, weave.inputs, strict=False):
        shader.link(wave, socket)
    uneven = shader.noise(at, 60.0, detail=6)
    mixed = shader.node("ShaderNodeMath", operation="MULTIPLY")
    shader.link(weave.outputs[0], mixed.inputs[0])
    shader.link(uneven, mixed.inputs[1])
    gap = tuple(c * (1 - contrast) for c in colour)
    shader.set(
        base_color=shader.ramp(mixed.outputs[0], [(0.05, gap), (0.55, colour)]),
        roughness=0.9,
        sheen_weight=0.35,
    )
    shader.bump(weave.outputs[0], strength=0.6, distance=0.0006)
    return shader.material


def ceramic(
    name: str = "ceramic", colour: Triple = (0.82, 0.81, 0.78), *, roughness: float = 0.12
) -> bpy.types.Material:
    """Return glazed ceramic: a mug, a plate, a vase.

    Parameters
    ----------
    name : str
    colour : sequence of 3 floats
    roughness : float

    Returns
    -------
    bpy.types.Material
    """
    shader = Shader(name)
    shader.set(base_color=tuple(colour), roughness=roughness, coat_weight=0.6, coat_roughness=0.05)
    waviness = shader.noise(shader.coordinates(), 25.0, detail=1)
    shader.bump(waviness, strength=0.05, distance=0.002)
    return shader.material
