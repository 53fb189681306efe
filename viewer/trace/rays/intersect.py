"""Intersection of rays with triangles and curves: a small interface that Embree and a BVH in a shader implement.

The rays of a wavefront are in its state textures. The results go to its `hit` texture (RGBA32UI, one texel for each
path): x = free << 31 | kind << KIND_SHIFT | instance, y = triangle within its mesh, z and w = float bits of the
barycentric coordinates u of vertex 1 and v of vertex 2. `free` means that the path's shadow ray is unoccluded. A ray
that hits nothing has x = `MISS`. Both sides of triangles are hit, and only the outside of curves. A hit on a curve has
the number of the set in place of that of the instance, and y is the row of the segment's first point
(viewer/trace/scene/curves.py).

In scenes with scattering or panes the texture `along` (RGBA32F) has in rgb the transmittance of the shadow ray through
the media and panes on its way, 0 if something occludes it, and in a the distance to the hit, negative if there is none.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import moderngl
import numpy as np

from ...errors import UsageError
from ...gpu.context import Context

if TYPE_CHECKING:
    from ..scene.geometry import TraceGeometry

SHADOW_REACH = 1 - 1e-5
"""The part of its vector that a shadow ray tests. It ends before the light, whose own triangle must not occlude it."""

CLASS_OF_IDLE = 255
"""Of idle paths in `Answer.classes`."""

EMBREE_TRIANGLES = 20_000_000
"""Embree copies the triangles of every instance, at about 120 bytes each. Above this number the BVH is used."""


class WavefrontTextures(Protocol):
    """The textures of a wavefront, all of one size. An intersector reads the first five and writes the others.

    Only scenes with scattering need `medium`, and only those and scenes with panes `along`.
    """

    origin: moderngl.Texture  # xyz, and w, whose sign is the status of viewer/trace/layout.py
    direction: moderngl.Texture
    shadow_origin: moderngl.Texture  # or the same as `origin`
    shadow_vector: moderngl.Texture  # 0: there is no shadow ray
    medium: moderngl.Texture
    hit: moderngl.Texture
    along: Any
    sees_backs: bool
    """Whether shadow rays go to the camera, and so pass single-sided surfaces if they come to the front."""

    @property
    def rows(self) -> int:
        """The number of rows whose paths may not be idle: all after them are."""

    def read(self, name: str, texels: np.ndarray) -> None:
        """Read these rows of one of the first five textures into the first of (texels, 4) float32. Waits for the
        device."""


@dataclass
class Answer:
    """The result of a trace.

    `alive` is the number of paths that are not idle, `rays` the number of rays; None: unknown yet.
    """

    alive: int | None
    rays: int | None
    hits: Any = None
    """(paths, 4) uint32 for the first rows of the hit texture, if they are not on the device already."""
    along: Any = None
    """(paths, 4) float32 for the texture `along`, likewise."""
    classes: Any = None
    """(paths,) uint8, of an intersector that tells them: NO_KIND of paths that have ended or whose ray meets nothing,
    CLASS_OF_IDLE of idle ones, and of all others the kind of surface that their ray meets. Of paths in media it is a
    number of its own for each kind, since they may collide before."""

    @staticmethod
    def joined(parts: Sequence[Answer]) -> Answer:
        """One answer of those for parts of a wavefront, in memory."""
        def rows(name: str) -> Any:
            arrays = [getattr(part, name) for part in parts]
            return arrays[0] if arrays[0] is None or len(arrays) == 1 else np.concatenate(arrays)

        return Answer(sum(part.alive or 0 for part in parts), sum(part.rays or 0 for part in parts),
                      rows("hits"), rows("along"), rows("classes"))


class Surfaces(Protocol):
    """What `coverage_at` of shaders/trace/material.glsl needs: its defines, and its textures and uniforms."""

    switches: dict[str, int]

    def bind(self, program: moderngl.Program) -> None: ...


class Intersector(Protocol):
    """Traces in three steps, so that software OpenGL can shade one wavefront while another is traced:
    `rays = fetch(a)`, `store(b, finish_b())`, shade b, flush, `finish_a = begin(rays)`. The rays are valid until they
    are traced."""

    name: str
    tells_classes: bool

    def fetch(self, wavefront: WavefrontTextures) -> Any:
        """The rays of the wavefront's present state. Waits for the device if it has to read them."""

    def begin(self, rays: Any) -> Callable[[], Answer]:
        """Begin to find the hits of the rays. The result waits for them, if other threads are at it."""

    def trace(self, rays: Any) -> Answer:
        """Find the hits of the rays."""

    def store(self, wavefront: WavefrontTextures, answer: Answer) -> None:
        """Write the answer to the wavefront's hit texture."""

    def move(self, geometry: TraceGeometry) -> None:
        """Take other triangles, such as those that have moved; some are see-through if and only if some were."""

    def release(self) -> None:
        """Free its resources on the device."""


def make_intersector(
    context: Context, geometry: TraceGeometry, surfaces: Surfaces | None = None, kind: str = "auto"
) -> Intersector:
    """An intersector of the scene's triangles.

    `kind` is embree, bvh or auto: Embree if OpenGL runs in software and Embree is installed, else the BVH. `surfaces`
    is needed only for scenes with see-through surfaces; without it, panes occlude shadow rays. Raises UsageError if
    Embree is asked for and cannot be used, ViewerError for a scene whose BVH no texture holds.
    """
    if kind not in ("auto", "embree", "bvh"):
        raise UsageError(f"no intersector {kind!r}; there are auto, embree, bvh")
    if kind == "embree" or (kind == "auto" and context.is_software):
        try:
            from .embree import EmbreeIntersector
            if geometry.curves is not None:
                from .embree_curves import embree_with_curves

                embree_with_curves()
        except ImportError as error:
            if kind == "embree":
                raise UsageError(f"Embree cannot be used ({error}); install embreex, or take the bvh") from error
        else:
            triangles = sum(len(geometry.meshes[instance.mesh].triangles) for instance in geometry.instances)
            if kind == "embree" or triangles <= EMBREE_TRIANGLES:
                return EmbreeIntersector(context, geometry, surfaces)
    from .bvh_shader import BvhIntersector

    return BvhIntersector(context, geometry, surfaces)
