"""Stand-ins for scenes and wavefronts that have only what intersectors use."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace

import moderngl
import numpy as np

from viewer.gpu.context import Context
from viewer.gpu.ray_textures import WholeTextures
from viewer.trace.kinds import SURFACE, Kind
from viewer.trace.rays.intersect import Intersector
from viewer.trace.scene.curves import TraceCurves
from viewer.trace.scene.geometry import TraceGeometry


@dataclass
class Mesh:
    positions: np.ndarray
    triangles: np.ndarray


@dataclass
class Instance:
    mesh: int
    transform: np.ndarray
    kind: Kind = SURFACE
    see_through: bool = False
    has_open_back: bool = False
    is_pane: bool = False
    is_mirrored: bool = False


@dataclass
class Geometry:
    meshes: list[Mesh]
    instances: list[Instance] = field(default_factory=list)
    scatters: bool = False
    curves: TraceCurves | None = None

    def __post_init__(self) -> None:
        if not self.instances:
            self.instances = [Instance(index, np.eye(3, 4)) for index in range(len(self.meshes))]

    has_triangles_of = TraceGeometry.has_triangles_of


def mesh(positions: object, triangles: object) -> Mesh:
    return Mesh(np.asarray(positions, np.float32).reshape(-1, 3), np.asarray(triangles, np.uint32).reshape(-1, 3))


def sphere(rings: int, segments: int, radius: float = 1.0) -> Mesh:
    """A closed sphere whose triangles share vertices."""
    polar, around = np.pi * np.arange(1, rings) / rings, np.arange(segments)
    theta, phi = np.meshgrid(polar, 2 * np.pi * around / segments, indexing="ij")
    ring = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1).reshape(-1, 3)
    positions = radius * np.concatenate([[(0, 1, 0)], ring, [(0, -1, 0)]])
    row, column = np.meshgrid(np.arange(rings - 2), around, indexing="ij")
    a, b = 1 + row * segments + column, 1 + row * segments + (column + 1) % segments
    last = len(positions) - 1
    lowest = last - segments
    top = np.stack([np.zeros_like(around), 1 + (around + 1) % segments, 1 + around], 1)
    bottom = np.stack([np.full_like(around, last), lowest + around, lowest + (around + 1) % segments], 1)
    sides = np.stack([a, b, a + segments, b, b + segments, a + segments], -1).reshape(-1, 3)
    return mesh(positions, np.concatenate([top, sides, bottom]))


def soup(count: int, size: float, seed: int = 0) -> Mesh:
    """Random triangles in the unit cube, which do not share edges."""
    rng = np.random.default_rng(seed)
    centers = rng.uniform(-1, 1, (count, 1, 3))
    return mesh(centers + size * rng.normal(size=(count, 3, 3)), np.arange(3 * count))


class Textures(WholeTextures, SimpleNamespace):
    pass


def make_wavefront(gl: moderngl.Context, size: tuple[int, int]) -> Textures:
    """A wavefront whose paths are all idle."""
    names, zeros = ("origin", "direction", "shadow_origin", "shadow_vector"), bytes(16 * size[0] * size[1])
    textures = {name: gl.texture(size, 4, zeros, dtype="f4") for name in names}
    wavefront = Textures(**textures, hit=gl.texture(size, 4, dtype="u4"))
    for texture in vars(wavefront).values():
        texture.filter = moderngl.NEAREST, moderngl.NEAREST
    wavefront.along = None
    return wavefront


def fill(wavefront: SimpleNamespace, **states: np.ndarray) -> None:
    """Write arrays (rays, 3 or 4) to the first texels of state textures; the others become 0."""
    for name, values in states.items():
        texture = getattr(wavefront, name)
        texels = np.zeros((texture.width * texture.height, 4), np.float32)
        texels[: len(values), : values.shape[1]] = values
        texture.write(texels)


def trace(
    context: Context,
    intersector: Intersector,
    origin: np.ndarray,
    direction: np.ndarray,
    shadow_origin: np.ndarray | None = None,
    shadow_vector: np.ndarray | None = None,
) -> np.ndarray:
    """(rays, 4) uint32: the texels of the hit texture for rays (rays, 3), in a wavefront just big enough."""
    width = 256
    wavefront = make_wavefront(context.gl, (width, -(-len(origin) // width)))
    fill(wavefront, origin=np.c_[origin, np.ones(len(origin))], direction=np.asarray(direction))
    if shadow_origin is not None and shadow_vector is not None:
        fill(wavefront, shadow_origin=np.asarray(shadow_origin), shadow_vector=np.asarray(shadow_vector))
    intersector.store(wavefront, intersector.trace(intersector.fetch(wavefront)))
    return np.frombuffer(wavefront.hit.read(), np.uint32).reshape(-1, 4)[: len(origin)]
