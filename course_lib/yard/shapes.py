"""Low-poly building blocks as plain arrays: quads and triangles with texture coordinates.

A mesh is vertices float32 (N, 3) in metres, z up; faces int32 (M, 3), counter-clockwise seen from
outside; uv float32 (N, 2), (0, 0) at the bottom left of the texture. Vertices are not shared
between facets, so that every facet keeps its own corner of the texture and its flat shade.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray


class Mesh(NamedTuple):
    """Vertices (N, 3) in metres, faces (M, 3), uv (N, 2)."""

    vertices: NDArray[np.float32]
    faces: NDArray[np.int32]
    uv: NDArray[np.float32]


def polygons(corners: ArrayLike, uv: ArrayLike | None = None) -> Mesh:
    """Mesh of K separate triangles or quads.

    Parameters
    ----------
    corners : (K, 3, 3) or (K, 4, 3)
        Counter-clockwise from outside.
    uv : (K, 3, 2) or (K, 4, 2), optional
        Zero when left out (for parts of one colour).
    """
    corners = np.asarray(corners, np.float32)
    count, sides = corners.shape[:2]
    uv = np.zeros((count, sides, 2)) if uv is None else np.asarray(uv)
    fan = np.array([[0, k, k + 1] for k in range(1, sides - 1)])
    faces = (np.arange(count)[:, None, None] * sides + fan[None]).reshape(-1, 3)
    return Mesh(
        corners.reshape(-1, 3), faces.astype(np.int32), uv.reshape(-1, 2).astype(np.float32)
    )


def join(meshes: Sequence[Mesh]) -> Mesh:
    """One mesh of several."""
    starts = np.cumsum([0] + [len(m.vertices) for m in meshes[:-1]])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.faces + s for m, s in zip(meshes, starts, strict=True)]).astype(np.int32),
        np.concatenate([m.uv for m in meshes]),
    )


def moved(mesh: Mesh, offset: ArrayLike, turn: float = 0.0) -> Mesh:
    """Turn a mesh by ``turn`` degrees about z, then shift it by ``offset`` metres."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return mesh._replace(vertices=(mesh.vertices @ R.T + offset).astype(np.float32))


def quad(
    corners: Any,  # noqa: ANN401 (four points, as arrays or tuples)
    repeat: tuple[float, float] = (1, 1),
) -> Mesh:
    """Make one quad; its texture runs from the first corner (bottom left), ``repeat`` times."""
    ru, rv = repeat
    return polygons([corners], np.array([[[0, 0], [ru, 0], [ru, rv], [0, rv]]]))


def box(size: Sequence[float], tile: float = 1.0) -> Mesh:
    """Box standing on z = 0, centred in x and y; one texture tile spans ``tile`` metres."""
    sx, sy, sz = size
    x, y = sx / 2, sy / 2
    b = [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)]
    t = [(px, py, sz) for px, py, _ in b]
    meshes = [
        quad([b[k], b[(k + 1) % 4], t[(k + 1) % 4], t[k]], ((sx, sy)[k % 2] / tile, sz / tile))
        for k in range(4)
    ]
    meshes.append(quad(t, (sx / tile, sy / tile)))
    meshes.append(quad(b[::-1], (sx / tile, sy / tile)))
    return join(meshes)


def rod(
    start: ArrayLike, end: ArrayLike, radii: tuple[float, float], sides: int = 8, tile: float = 1.0
) -> Mesh:
    """Make a closed prism from ``start`` to ``end``, metres; ``radii`` at both ends, u along it."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    axis = end - start
    length = float(np.linalg.norm(axis))
    axis = axis / length
    helper = np.array([0.0, 0, 1]) if abs(axis[2]) < 0.9 else np.array([1.0, 0, 0])
    e1 = np.cross(helper, axis)
    e1 = e1 / np.linalg.norm(e1)
    e2 = np.cross(axis, e1)
    angles = np.arange(sides + 1) * 2 * np.pi / sides
    around = np.cos(angles)[:, None] * e1 + np.sin(angles)[:, None] * e2
    low, high = start + radii[0] * around, end + radii[1] * around
    corners = np.stack([low[:-1], low[1:], high[1:], high[:-1]], axis=1)
    v = angles * max(radii) / tile
    u = length / tile
    uv = np.array([[[0, v[k]], [0, v[k + 1]], [u, v[k + 1]], [u, v[k]]] for k in range(sides)])
    caps = [
        polygons(np.stack([np.broadcast_to(c, (sides, 3)), *pair], axis=1))
        for c, pair in ((start, (low[1:], low[:-1])), (end, (high[:-1], high[1:])))
    ]
    return join([polygons(corners, uv), *caps])


def ring(
    outer: float, inner: float, low: float, high: float, sides: int = 14, rows: float = 1.0
) -> Mesh:
    """Upright tube with a wall: outside, top and inside; the texture goes once around it."""
    angles = np.arange(sides + 1) * 2 * np.pi / sides + np.pi / sides
    unit = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    up = np.array([0, 0, 1.0])
    ob, ot = unit * outer + up * low, unit * outer + up * high
    ib, it = unit * inner + up * low, unit * inner + up * high
    u = np.arange(sides + 1) / sides
    meshes = []
    for a, b, v0, v1 in ((ob, ot, 0.0, rows), (ot, it, 0.7 * rows, rows), (it, ib, rows, 0.0)):
        corners = np.stack([a[:-1], a[1:], b[1:], b[:-1]], axis=1)
        uv = [[[u[k], v0], [u[k + 1], v0], [u[k + 1], v1], [u[k], v1]] for k in range(sides)]
        meshes.append(polygons(corners, uv))
    return join(meshes)


@cache
def _ball() -> NDArray[np.float64]:
    """Give the 80 facets of a once-cut icosahedron: corners (80, 3, 3) on the unit ball."""
    g = (1 + 5**0.5) / 2
    points: list[tuple[float, float, float]] = [
        (-1, g, 0),
        (1, g, 0),
        (-1, -g, 0),
        (1, -g, 0),
        (0, -1, g),
        (0, 1, g),
    ]
    points += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    p = np.array(points, float)
    gaps = np.linalg.norm(p[:, None] - p[None], axis=2)
    near = (gaps > 0) & (gaps < 2.01)
    triangles = []
    for a in range(12):
        for b in range(a + 1, 12):
            for c in range(b + 1, 12):
                if near[a, b] and near[b, c] and near[a, c]:
                    outward = np.dot(np.cross(p[b] - p[a], p[c] - p[a]), p[a]) > 0
                    triangles.append((a, b, c) if outward else (a, c, b))
    pieces = []
    for a, b, c in triangles:
        ab, bc, ca = (p[a] + p[b]) / 2, (p[b] + p[c]) / 2, (p[c] + p[a]) / 2
        pieces += [(p[a], ab, ca), (ab, p[b], bc), (ca, bc, p[c]), (ab, bc, ca)]
    corners = np.array(pieces)
    return np.asarray(corners / np.linalg.norm(corners, axis=2, keepdims=True))


def blob(radii: Sequence[float], rng: np.random.Generator, *, rough: float = 0.12) -> Mesh:
    """Dented ball of 80 facets, centred at the origin: foliage, clouds, heads."""
    corners = _ball()
    # A dent belongs to a direction, so that facets which share a corner keep sharing it.
    waves = rng.normal(0, 2.2, (5, 3))
    phase = rng.uniform(0, 2 * np.pi, 5)
    dents = 1 + rough * np.sin(corners @ waves.T + phase).sum(axis=2, keepdims=True) / 2
    uv = corners[..., [0, 2]] * 0.5 + corners[..., [1, 1]] * 0.25
    return polygons(corners * dents * np.asarray(radii), uv * 1.5 * max(radii))


def tuft(rng: np.random.Generator, *, blades: int = 9, height: float = 0.22) -> Mesh:
    """Make a tuft of grass: bent blades, each visible from both sides."""
    corners = []
    for _ in range(blades):
        angle, lean = rng.uniform(0, 2 * np.pi), rng.uniform(0.05, 0.14)
        foot = rng.uniform(-0.05, 0.05, 3) * (1, 1, 0)
        across = 0.013 * np.array([-np.sin(angle), np.cos(angle), 0])
        tip = foot + (lean * np.cos(angle), lean * np.sin(angle), height * rng.uniform(0.6, 1.1))
        corners += [(foot - across, foot + across, tip), (foot + across, foot - across, tip)]
    return polygons(corners)
