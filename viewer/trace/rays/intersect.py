"""Where rays meet triangles: one small interface, with Embree or a BVH in a shader behind it.

A wave's rays are in its state textures and the answers go to its `hit` texture (RGBA32UI, a texel a slot):
x = free << 31 | kind << KIND_SHIFT | instance, y = triangle within its mesh, z and w the float bits of the barycentrics
u of vertex 1 and v of vertex 2. `free` says that the slot's shadow ray met nothing. A ray that met nothing has `MISS`.
Nothing is culled.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import moderngl

from ...errors import UsageError
from ...gpu.context import Context

if TYPE_CHECKING:
    from ..scene.geometry import TraceGeometry

SHADOW_REACH = 1 - 1e-5
"""How far along its vector a shadow ray looks: not as far as the light, whose own triangle must not hide it."""

EMBREE_TRIANGLES = 20_000_000
"""Embree has every instance's triangles once more, at some 120 bytes each; above this many the BVH is taken."""


class WaveTextures(Protocol):
    """The textures of a wave, all of one size, that an intersector reads and, the last, writes."""

    origin: moderngl.Texture  # xyz, and w: 0 idle, 1 a ray in flight, 2 only a shadow ray is pending
    direction: moderngl.Texture
    shadow_origin: moderngl.Texture
    shadow_vector: moderngl.Texture  # 0 where there is no shadow ray
    hit: moderngl.Texture


@dataclass
class Answer:
    """What a trace found. `alive` counts the slots that have any ray, `rays` the rays; None: not known yet."""

    alive: int | None
    rays: int | None
    words: Any = None
    """(slots, 4) uint32 for the hit texture, where it is not on the device already."""


class Surfaces(Protocol):
    """What `coverage_at` of shaders/trace/material.glsl needs: defines, and what to bind before it is used."""

    switches: dict[str, int]

    def bind(self, program: moderngl.Program) -> None: ...


class Intersector(Protocol):
    """Three steps, so that a driver that draws on this machine's processors can shade one wave while another is traced:
    `rays = fetch(a)`, `store(b, ...)`, shade b, flush, `trace(rays)`. Rays are good until the next fetch."""

    name: str

    def fetch(self, wave: WaveTextures) -> Any:
        """The rays of the wave's present state; waits for the device where it has to read them."""

    def trace(self, rays: Any) -> Answer:
        """Find what they meet."""

    def store(self, wave: WaveTextures, answer: Answer) -> None:
        """Put the answer into the wave's hit texture."""

    def release(self) -> None:
        """Free what it holds on the device."""


def make_intersector(
    context: Context, geometry: TraceGeometry, surfaces: Surfaces | None = None, kind: str = "auto"
) -> Intersector:
    """An intersector of the scene's triangles.

    `kind` is embree, bvh or auto: Embree where OpenGL is software and Embree is installed, the BVH elsewhere.
    `surfaces` is needed only where something is see-through. Raises UsageError where Embree is asked for and cannot be
    had, ViewerError for a scene whose BVH no texture holds.
    """
    if kind not in ("auto", "embree", "bvh"):
        raise UsageError(f"no intersector {kind!r}; there are auto, embree, bvh")
    if kind == "embree" or (kind == "auto" and context.is_software):
        try:
            from .embree import EmbreeIntersector
        except ImportError as error:
            if kind == "embree":
                raise UsageError(f"Embree cannot be used ({error}); install embreex, or take the bvh") from error
        else:
            triangles = sum(len(geometry.meshes[instance.mesh].triangles) for instance in geometry.instances)
            if kind == "embree" or triangles <= EMBREE_TRIANGLES:
                return EmbreeIntersector(context, geometry, surfaces)
    from .bvh_shader import BvhIntersector

    return BvhIntersector(context, geometry, surfaces)
