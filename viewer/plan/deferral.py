"""Which surfaces may be shaded after all triangles are drawn (viewer/raster/deferred.py)."""

from __future__ import annotations

from collections.abc import Mapping

from ..scene.material import Material
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from .samplers import MAX_SAMPLERS, sampler_count

MOST_VERTICES = 1 << 20
"""In one mesh: its vertices and triangles are texels, and indices of vertices are floats there."""
TRIANGLE_BITS = 22
MOST_OBJECTS, MOST_TRIANGLES = 64, (1 << TRIANGLE_BITS) - 1
"""In one picture: each object takes a pass over the pixels that it may touch, and a triangle's number has these bits
beside the six of its object and four for samples."""
MOST_TEXELS = max(5 * MOST_VERTICES, MOST_TRIANGLES)
"""Of a buffer: a mesh has one for each triangle and four for each vertex, a picture one for each triangle."""
_NEEDS_VERTICES = ("HAS_COLOR", "INDIRECT", "SUBSURFACE", "WOVEN", "INSTANCED")
"""Switches of what vertices have beside their normals, tangents and texture coordinates, of what needs derivatives that
a pixel cannot tell alone, and of meshes that stand in many places. Colours of vertices may change where triangles join
smoothly."""


def is_worth_deferring(scene: Scene) -> bool:
    """Whether a scene has few enough objects and triangles."""
    triangles = sum(scene.meshes[instance.mesh].triangle_count for instance in scene.instances[:MOST_OBJECTS])
    return len(scene.instances) <= MOST_OBJECTS and triangles <= MOST_TRIANGLES


def can_defer(mesh: Mesh, material: Material, switches: Mapping[str, int]) -> bool:
    """Whether what the program with these switches draws may be: opaque triangles, which hide all that is behind."""
    is_plain = material.alpha_mode == "opaque" and not material.transmits and mesh.topology == "triangles"
    return (is_plain and not any(switches.get(name) for name in _NEEDS_VERTICES)
            and max(len(mesh.positions), mesh.triangle_count) <= MOST_VERTICES
            and sampler_count(dict(switches) | {"DEFERRED": 1}) <= MAX_SAMPLERS)
